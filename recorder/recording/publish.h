// SPDX-License-Identifier: GPL-3.0-or-later
// New files get a temporary name until they are whole. Internal to recorder/.
#pragma once

#include <filesystem>

namespace calot::recorder {

/// TARGET.part, in the target's folder.
std::filesystem::path temporaryName(const std::filesystem::path& target);

/// @throws Error invalid if the target exists and force is not set, or if its folder does not exist.
void refuseExisting(const std::filesystem::path& target, bool force);

/// Renames in one move; without force it never replaces a file. @throws Error invalid (exists) or failure.
void publish(const std::filesystem::path& temporary, const std::filesystem::path& target, bool force);

}  // namespace calot::recorder
