// SPDX-License-Identifier: GPL-3.0-or-later
// assets/golden/golden.json: which golden recordings there are, how each is made, and what its checkpoints gave when it
// was made. docs/how-to/golden.md says how to review a change of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace calot::apps {

/// A checkpoint's value when the recording was made; in SI units.
struct GoldenValue {
  std::string name, subject;
  std::uint32_t version = 0;  ///< of the checkpoint's definition
  double value = 0.0;
  bool operator==(const GoldenValue&) const = default;
};

/// One recording and how to make it: a performer in a scene, up to so many seconds.
struct GoldenEntry {
  std::string file;  ///< base name, beside the list
  std::string scene, performer;
  std::uint32_t seed = 1;
  double seconds = 0.0;  ///< 0: until the performer ends
  std::vector<GoldenValue> values;
};

struct GoldenList {
  std::uint32_t simulationVersion = 0;  ///< of all recordings
  std::string reason;                   ///< why they were made anew
  std::string valuesReason;             ///< why values were taken over since; empty: they were not
  std::vector<GoldenEntry> recordings;
};

/// @throws Error (damaged) naming file and place. A list with a file's name that is no base name, or given twice, is
/// refused.
GoldenList readGoldenList(const std::filesystem::path& file);

/// The list as JSON; every number reads back as the same bits.
std::string toJson(const GoldenList& list);

}  // namespace calot::apps
