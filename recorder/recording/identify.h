// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace calot::recorder {

/// Identity of a recording's attempt.
struct RecordingIdentity {
  std::string attempt, parent;  ///< uuids; parent empty: no branch
  std::string participant;      ///< pseudonym, or empty
  std::uint64_t steps = 0;
  bool complete = false;
  std::array<std::byte, 32> chainHead{};  ///< as stored; not recomputed
};

/// Reads it from header and status, in a child process (a hostile file harms nothing). @throws Error as Recording does.
RecordingIdentity identify(const std::filesystem::path& path);

/// Does the file begin as an HDF5 file does? False also where it cannot be read.
bool looksLikeHdf5(const std::filesystem::path& path);

/// Regular files in these folders and below, and these files themselves, by name, each once; links are not followed.
/// @throws Error damaged: a folder or file is not there or cannot be read.
std::vector<std::filesystem::path> filesUnder(const std::vector<std::filesystem::path>& places);

}  // namespace calot::recorder
