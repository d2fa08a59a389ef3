// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace calot::analytics {

/// Effective rate of a tracker, from the intervals between its samples.
///
/// Where poses alone tell samples apart, one that is equal to the one before isn't seen, so a hand that stands
/// still makes intervals of several periods. Therefore: the mean of the intervals of at most 1.5 times their median.
/// Intervals over 0.1 s are rest or no measurement. Deterministic contract.
class SampleRate {
 public:
  /// @param seconds since the sample before, > 0.
  void add(double seconds);
  /// Hz; 0 where there was no interval of at most 0.1 s.
  [[nodiscard]] double hertz() const;

 private:
  /// Intervals by their length, to 10 us.
  struct Bin {
    std::uint64_t count = 0;
    double seconds = 0.0;
  };
  std::vector<Bin> bins_;
  std::uint64_t count_ = 0;
};

}  // namespace calot::analytics
