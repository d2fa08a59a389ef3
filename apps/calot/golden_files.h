// SPDX-License-Identifier: GPL-3.0-or-later
// assets/golden/golden.json: which golden recordings there are, how each is made, and what its checkpoints gave when it
// was made. docs/how-to/golden.md says how to review a change of it.
// Checkpoint values of golden recordings, compared with the list.
// Making golden recordings anew.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "recorder/replay.h"
#include "sim/math/record.h"

namespace calot::apps {

/// A checkpoint's value when the recording was made; in SI units.
struct GoldenValue {
  std::string name, subject;
  std::uint32_t version = 0;  ///< of the checkpoint's definition
  double value = 0.0;
  static std::vector<Field> fields();
  bool operator==(const GoldenValue&) const = default;
};

/// One recording and how to make it: a performer in a scene, up to so many seconds.
struct GoldenEntry {
  std::string file;  ///< base name, beside the list
  std::string scene, performer;
  std::uint32_t seed = 1;
  double seconds = 0.0;  ///< 0: until the performer ends
  std::vector<GoldenValue> values;

  static std::vector<Field> fields();
};

struct GoldenList {
  std::uint32_t simulationVersion = 0;  ///< of all recordings
  std::string reason;                   ///< why they were made anew
  std::string valuesReason;             ///< why values were taken over since; empty: they were not
  std::vector<GoldenEntry> recordings;

  static std::vector<Field> fields();
};

/// @throws Error (damaged) naming file and place. A list with a file's name that is no base name, or given twice, is
/// refused.
GoldenList readGoldenList(const std::filesystem::path& file);

/// The list as JSON; every number reads back as the same bits.
std::string toJson(const GoldenList& list);

/// The values that there are, as the list keeps them.
std::vector<GoldenValue> goldenValues(const std::vector<analytics::CheckpointValue>& values);

/// One line for each checkpoint whose value is not the same in both, "path-length left: 123.4 mm -> 125.0 mm"; empty
/// where all are, to the bit.
std::vector<std::string> changedValues(const std::vector<GoldenValue>& before, const std::vector<GoldenValue>& now);

/// A replay of a golden recording.
struct GoldenReplay {
  recorder::ReplayReport report;
  std::vector<GoldenValue> values;   ///< where it is bit-exact
  std::vector<std::string> changed;  ///< changedValues() from the list's; the verdict is then `diverged`
};

GoldenReplay replayGolden(const std::filesystem::path& file, const GoldenEntry& entry, unsigned threads);

/// Decides whether the list may take over a recording's values: each that changed has a definition of a higher version,
/// each that is gone belongs to a checkpoint that there is no longer, new ones are welcome.
/// @throws Error (refused) naming the first value that changed without its definition.
void refuseValues(const GoldenEntry& entry, const std::vector<GoldenValue>& now);

/// The reason given. @throws Error (invalid) where it says nothing.
const std::string& requiredReason(const std::string& reason);

/// Checks the preconditions of an update. @throws Error (invalid): the reason is empty; or all recordings are there
/// and of this build's simulation version; or the work tree that holds `folder` has changes outside of it, or is none.
void refuseUpdate(const std::filesystem::path& folder, const GoldenList& list, const std::string& reason);

/// Runs every recording of the list anew, then replaces files and list together. @param told after each one: the
/// entry before and now. @throws Error with nothing replaced.
void updateGolden(const std::filesystem::path& folder, const GoldenList& list, const std::string& reason,
                  const std::function<void(const GoldenEntry& before, const GoldenEntry& now)>& told);

}  // namespace calot::apps
