// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

namespace calot::recorder {

/// @throws Error (invalid) where `path` is a folder, exists and `force` is not set, or its folder does not exist: asked
/// before long work whose result goes there.
void refuseOutput(const std::filesystem::path& path, bool force);

/// Writes a whole file under the temporary name `path` + ".part" and renames it, so that `path` is never half-written.
/// @throws Error (invalid) as refuseOutput; (failure) where writing fails, with the temporary file removed.
void writeText(const std::filesystem::path& path, std::string_view text, bool force);

}  // namespace calot::recorder
