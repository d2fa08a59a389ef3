// SPDX-License-Identifier: GPL-3.0-or-later
// What a replay shows next: pure decisions, apart from the thread that carries them out.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace calot::gui {

/// Where a replay stands and what it can do.
struct ReplayReach {
  std::optional<std::uint64_t> step;         ///< the last step done; none before the first
  std::span<const std::uint64_t> keyframes;  ///< steps after which there is a keyframe, rising
  std::uint64_t budget = 1;                  ///< steps that may be re-simulated before the next picture
};

struct ReplayMove {
  std::uint64_t step = 0;  ///< to be shown next
  bool hops = false;       ///< re-simulation cannot keep pace: steps between were left out, by a keyframe
};

/// While playing. The picture that is due, if the budget leads there from here or from a keyframe; else the last
/// keyframe before it; else as far as the budget leads.
/// @param due step that the clock asks for
ReplayMove playTowards(const ReplayReach& reach, std::uint64_t due);

/// Steps to be re-simulated to stand at `step`: from here, or from the nearest keyframe, whichever is less.
std::uint64_t stepsTo(const ReplayReach& reach, std::uint64_t step);

/// On the way to a moment that was asked for: the nearest keyframe where that is better than going on from here, then
/// forward by the budget.
std::uint64_t seekTowards(const ReplayReach& reach, std::uint64_t target);

}  // namespace calot::gui
