// SPDX-License-Identifier: GPL-3.0-or-later
// From the words of `calot power` to the study that is simulated.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "analytics/statistics/power.h"
#include "apps/calot/study_options.h"

namespace calot::apps {

inline constexpr std::size_t maxPeople = 500;  ///< in a group

/// What the command line says.
struct PowerOptions {
  StudySource source;
  std::vector<std::string> checkpoints;
  std::vector<double> effects;
  std::string sizes = "5:30:5", shape = "normal", adjustment = "holm", seed = "1";
  double allocation = 1.0, correlation = 0.0, step = 0.0, level = 0.05, target = 0.8;
  std::uint64_t simulations = 0;
  bool json = false;
};

/// A study to be planned, without its sizes.
struct PlannedStudy {
  analytics::PowerPlan plan;
  std::vector<std::string> names;  ///< of its checkpoints
  /// Tests in the family of Holm's adjustment: a protocol's primary hypotheses, those without a test too; else names.
  std::size_t family = 0;
  std::array<std::string, 2> groups{"first group", "second group"};
  std::string origin;  ///< where the distributions are from, a sentence
  bool synthetic = false;
};

/// @throws Error (invalid) "power: WHAT".
[[noreturn]] void failPower(const std::string& what);

/// "5:30:5", "12" or "8,10,15": people in the first group. @throws Error (invalid)
std::vector<std::size_t> sizesOf(const std::string& text);

/// @throws Error (invalid) for words that say nothing or too much, and as studyOf().
PlannedStudy planOf(PowerOptions& options);

}  // namespace calot::apps
