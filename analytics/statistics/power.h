// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/standard_setting.h"

namespace calot::analytics {

enum class Adjustment : std::uint8_t { none, holm, benjaminiHochberg };

enum class PowerShape : std::uint8_t {
  normal,    ///< both groups normal
  lognormal  ///< exp of such a normal: times
};

/// Distribution of both groups' values of one checkpoint; of the lognormal, of their logarithms.
struct PlannedCheckpoint {
  NormalCurve x, y;
  [[nodiscard]] bool effect() const { return x.mean != y.mean; }
};

/// Checkpoints of deviation 1 in which x is shifted by these numbers of deviations; 0: no effect.
std::vector<PlannedCheckpoint> shifts(const std::vector<double>& effects);

/// A pool of people to draw from with replacement, each with a value or none for every checkpoint, which preserves
/// correlations and the frequency of missing values. A small pool is a rough estimate of the population.
struct PowerPopulation {
  std::array<std::vector<std::vector<std::optional<double>>>, 2> people;
};

/// A study to be planned: two groups, one value per participant and checkpoint.
struct PowerPlan {
  std::size_t nx = 10, ny = 10;
  std::vector<PlannedCheckpoint> checkpoints = shifts({0.8});
  std::optional<PowerPopulation> population;  ///< draws from it; then every checkpoint counts as an effect, and
                                              ///< `checkpoints`, `correlation` and `shape` are not used
  double correlation = 0.0;  ///< of a participant's checkpoints with each other, 0 <= r < 1: one common normal factor
  PowerShape shape = PowerShape::normal;
  double step = 0.0;  ///< > 0: values are rounded to multiples of it (counts, scores), which makes ties
  double level = 0.05;
  Adjustment adjustment = Adjustment::holm;
  std::size_t simulations = 10000;
  std::uint64_t seed = 1;
};

/// A share of counted cases, of simulations or of people, with Wilson's score interval.
struct SimulatedShare {
  double value = 0.0;
  Interval interval;
};
/// @pre hits <= of, of > 0
SimulatedShare wilsonShare(std::size_t hits, std::size_t of);

struct Power {
  std::vector<SimulatedShare> ofCheckpoint;  ///< rejected after adjustment; where the effect is 0, an error rate
  SimulatedShare anyEffect;                  ///< at least one checkpoint with an effect is rejected
  SimulatedShare allEffects;                 ///< all checkpoints with an effect are
  std::size_t untestable = 0;                ///< tests without an answer (all tied, a group without a value): p = 1
  std::uint64_t seed = 0;
};

/// Simulates the study: draws it, takes mannWhitney() as it is, exact or not, adjusts the p values of all
/// checkpoints together and compares them with the level. No answer for an empty group, no checkpoint, or parameters
/// out of their range.
Expected<Power> simulatePower(const PowerPlan& plan);

}  // namespace calot::analytics
