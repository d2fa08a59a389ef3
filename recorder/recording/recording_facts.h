// SPDX-License-Identifier: GPL-3.0-or-later
// Facts about recordings without reading their steps: identity, stored bytes, statistics of their devices.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "recorder/recording/reader.h"

namespace calot::recorder {

struct RecordingIdentity {
  std::string attempt, parent;  ///< uuids; parent empty: no branch
  std::string participant;      ///< pseudonym, or empty
  std::uint64_t steps = 0;
  bool complete = false;
  std::array<std::byte, 32> chainHead{};  ///< as stored; not recomputed

  static void fields(auto& self, auto& visit) {
    visit("attempt", self.attempt);
    visit("parent", self.parent);
    visit("participant", self.participant);
    visit("steps", self.steps);
    visit("complete", self.complete);
    visit("chain_head", self.chainHead);
  }
};

/// Reads it from header and status, in a child process (a hostile file harms nothing). @throws Error as Recording does.
RecordingIdentity identify(const std::filesystem::path& path);

/// Does the file begin as an HDF5 file does? False also where it cannot be read.
bool looksLikeHdf5(const std::filesystem::path& path);

/// Regular files in these folders and below, and these files themselves, by name, each once; links are not followed.
/// @throws Error damaged: a folder or file is not there or cannot be read.
std::vector<std::filesystem::path> filesUnder(const std::vector<std::filesystem::path>& places);

/// Size of one group at a recording's root in its file.
struct StoredBytes {
  std::string group;  ///< "keyframes"; "structure": object headers, indexes of chunks, and what is unused
  std::uint64_t bytes = 0;
  bool operator==(const StoredBytes&) const = default;
};

/// Bytes of a recording's file by group, as they are stored: compressed, with checksums. The largest comes first, and
/// all of them add up to the file's size. @pre probe() accepted the file @throws Error damaged
std::vector<StoredBytes> storedBytes(const std::filesystem::path& path);

struct RawStatistics {
  std::uint64_t samples = 0;  ///< in the recording
  std::uint64_t valid = 0;    ///< of these
  std::uint64_t used = 0;     ///< of these: a tick's pose was made from them
  std::uint64_t dropped = 0;  ///< came and could not be kept
  std::uint64_t missing = 0;  ///< numbers left out between the first sample and the last
  double rate = 0.0;          ///< effective: valid samples a second of host time, first to last (1/s); 0: unknown
  double maxInterval = 0.0;   ///< of host time between two valid samples (s)
};

/// Reads all of a hand's raw samples. @throws Error damaged.
RawStatistics rawStatistics(Recording& recording, Hand hand);

}  // namespace calot::recorder
