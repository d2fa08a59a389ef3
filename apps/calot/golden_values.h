// SPDX-License-Identifier: GPL-3.0-or-later
// What the checkpoints of golden recordings give, held against the list.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "apps/calot/golden_list.h"
#include "recorder/replay.h"

namespace calot::apps {

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

/// Whether the list may take over a recording's values: each that changed has a definition of a higher version, each
/// that is gone belongs to a checkpoint that there is no longer, new ones are welcome.
/// @throws Error (refused) naming the first value that changed without its definition.
void refuseValues(const GoldenEntry& entry, const std::vector<GoldenValue>& now);

}  // namespace calot::apps
