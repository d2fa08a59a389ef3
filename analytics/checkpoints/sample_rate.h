// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace calot::analytics {

/// A tracker's own interval and its rate by the clock, from the times between its samples. Times over `longestInterval`
/// are pauses and count for neither. Deterministic contract.
class SampleRate {
 public:
  static constexpr double longestInterval = 1.0;  ///< s

  /// @param seconds since the sample before, > 0.
  void add(double seconds);

  /// The tracker's own interval (s): the median. Where intervals up to 1.5 medians fill less than a tenth of the time,
  /// samples arrive in bursts, and it is the interval up to which intervals fill half of the time. 0: none was added.
  [[nodiscard]] double interval() const;

  /// Intervals of at most `longest` (s) by the time that they fill (Hz); 0: there is none.
  [[nodiscard]] double hertz(double longest) const;

 private:
  /// Intervals by their length, to 10 us.
  struct Bin {
    std::uint64_t count = 0;
    double seconds = 0.0;
  };
  /// Intervals of at most so many seconds together.
  [[nodiscard]] Bin upTo(double longest) const;

  std::vector<Bin> bins_;
  Bin all_;
};

}  // namespace calot::analytics
