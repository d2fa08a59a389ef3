// SPDX-License-Identifier: GPL-3.0-or-later
// The one shape that files of recordings have (schemas/recording-integrity.md, "Shape"). Internal to this folder.
#pragma once

#include <cstdint>
#include <filesystem>

#include "recorder/recording/hdf5.h"

namespace calot::recorder {

/// Names that one group may hold, and attributes of one object. The format has 130 and at most 999 assets, and 29.
inline constexpr std::uint64_t maxLinks = 4096;
inline constexpr std::uint64_t maxAttributes = 256;
/// Stored together, and so unfolded together (bytes). Those of the format have 64 KiB, names more.
inline constexpr std::uint64_t maxChunkBytes = std::uint64_t{4} << 20U;

/// Looks at every link and every data set's description, and reads no data: links to other places, second names of an
/// object, data kept in other files or made of other data sets, filters from elsewhere, values of variable length,
/// chunks that unfold to more than maxChunkBytes, and extents that the file cannot hold.
/// What cannot be described is left to whoever reads it. The caller holds the HDF5 session.
/// @throws Error damaged naming the object
void checkShape(const std::filesystem::path& path, const hdf5::Id& file, std::uint64_t fileBytes);

}  // namespace calot::recorder
