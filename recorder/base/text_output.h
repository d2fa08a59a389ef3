// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

namespace calot::recorder {

/// @throws Error (invalid) where `path` is a folder, exists and `force` is not set, or its folder does not exist: asked
/// before long work whose result goes there.
void refuseOutput(const std::filesystem::path& path, bool force);

/// PATH.part, in the same folder: the name that a new file has until it is whole.
std::filesystem::path temporaryName(const std::filesystem::path& path);

/// Renames in one move; without force it never replaces a file. @throws Error (invalid) where `path` exists; (failure)
void publish(const std::filesystem::path& temporary, const std::filesystem::path& path, bool force);

/// Writes a whole file under the temporary name `path` + ".part" and renames it, so that `path` is never half-written.
/// @throws Error (invalid) as refuseOutput; (failure) where writing fails, with the temporary file removed.
void writeText(const std::filesystem::path& path, std::string_view text, bool force);

}  // namespace calot::recorder
