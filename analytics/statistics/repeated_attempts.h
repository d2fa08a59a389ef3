// SPDX-License-Identifier: GPL-3.0-or-later
// Several attempts of one person are not independent. Which rule makes one value of them is declared before the first
// attempt; the random-intercept model (random_intercept.h) is the third.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

struct RepeatedValue {
  std::size_t participant = 0;
  double order = 0.0;  ///< of that participant's attempts: number or time
  double value = 0.0;
};

enum class AttemptRule : std::uint8_t { first, mean };

struct ParticipantValue {
  std::size_t participant = 0;
  double value = 0.0;
  std::size_t attempts = 0;  ///< that there were
};

/// One value per participant, by ascending participant. No answer for no values, one that is not finite, or, for
/// `first`, two attempts of a participant with one order.
Expected<std::vector<ParticipantValue>> onePerParticipant(std::span<const RepeatedValue> values, AttemptRule rule);

}  // namespace calot::analytics
