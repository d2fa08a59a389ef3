// SPDX-License-Identifier: GPL-3.0-or-later
// Reading and checking a recording's header. Internal to this folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "recorder/base/identity.h"
#include "recorder/recording/hdf5.h"
#include "recorder/recording/reader.h"

namespace calot::recorder {

/// Root attributes, scene, names; whether there is a /device.
/// @throws Error damaged, naming the place.
AttemptHeader readHeader(const std::filesystem::path& path, const hdf5::Id& file, std::uint64_t fileBytes);

/// The station's key and signature, where there is a /signature. @throws Error damaged: of the wrong type or shape.
std::optional<RecordedSignature> readSignature(const std::filesystem::path& path, const hdf5::Id& file);

}  // namespace calot::recorder
