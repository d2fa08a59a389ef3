// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/replay_plan.h"

#include <algorithm>

namespace calot::gui {
namespace {

std::optional<std::uint64_t> keyframeAtOrBefore(const ReplayReach& reach, std::uint64_t step) {
  const auto after = std::upper_bound(reach.keyframes.begin(), reach.keyframes.end(), step);
  if (after == reach.keyframes.begin()) return std::nullopt;
  return *(after - 1);
}

/// From where the way to a step is shortest: here, a keyframe, or none for the attempt's start.
std::optional<std::uint64_t> bestStart(const ReplayReach& reach, std::uint64_t step) {
  const auto keyframe = keyframeAtOrBefore(reach, step);
  if (reach.step && *reach.step <= step && (!keyframe || *keyframe <= *reach.step)) return reach.step;
  return keyframe;
}

}  // namespace

std::uint64_t stepsTo(const ReplayReach& reach, std::uint64_t step) {
  const auto start = bestStart(reach, step);
  return start ? step - *start : step + 1;
}

ReplayMove playTowards(const ReplayReach& reach, std::uint64_t due) {
  if (stepsTo(reach, due) <= reach.budget) return {due, reach.step && due > *reach.step + reach.budget};
  const auto start = bestStart(reach, due);
  if (start && start != reach.step) return {*start, true};
  return {std::min(due, (start ? *start : 0) + reach.budget), false};
}

std::uint64_t seekTowards(const ReplayReach& reach, std::uint64_t target) {
  const auto start = bestStart(reach, target);
  if (start && start != reach.step) return *start;
  return std::min(target, start ? *start + reach.budget : reach.budget - 1);
}

}  // namespace calot::gui
