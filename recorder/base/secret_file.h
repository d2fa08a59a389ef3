// SPDX-License-Identifier: GPL-3.0-or-later
// Files that only their owner may read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace calot::recorder {

/// @throws Error damaged: not there, no regular file, larger than `most`; invalid: others than its owner may read or
/// write it.
std::string readSecret(const std::filesystem::path& path, std::size_t most);

/// Writes a file of mode 0600 as a whole: under a temporary name, to the disk, then renamed. @throws Error invalid: it
/// is there and `replace` is not set; failure: it cannot be written.
void writeSecret(const std::filesystem::path& path, std::string_view bytes, bool replace);

}  // namespace calot::recorder
