// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "recorder/formats/obj.h"

namespace calot::recorder {

/// parseObj() of a file. @throws Error (damaged)
TriangleMesh readObj(const std::filesystem::path& path, LengthUnit unit, const ObjLimits& limits = {});

/// Writes formatObj() under a temporary name, then renames.
/// @throws Error (invalid) where the file exists and `force` is not set, or its folder does not exist; (failure) where
/// writing fails. Nothing half-written stays.
void writeObj(const std::filesystem::path& path, const TriangleMesh& mesh, const std::string& comment, bool force);

}  // namespace calot::recorder
