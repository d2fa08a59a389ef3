// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace calot::recorder {

/// What one group at a recording's root takes in its file.
struct StoredBytes {
  std::string group;  ///< "keyframes"; "structure": object headers, indexes of chunks, and what is unused
  std::uint64_t bytes = 0;
  bool operator==(const StoredBytes&) const = default;
};

/// Bytes of a recording's file by group, as they are stored: compressed, with checksums. The largest comes first, and
/// all of them add up to the file's size. @pre probe() accepted the file @throws Error damaged
std::vector<StoredBytes> storedBytes(const std::filesystem::path& path);

}  // namespace calot::recorder
