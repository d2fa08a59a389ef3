// SPDX-License-Identifier: GPL-3.0-or-later
// Sets of times: which parts of an attempt a hand had an instrument, and in which of them nothing was measured.
#pragma once

#include <optional>
#include <vector>

namespace calot::analytics {

/// Times [begin, end) (s).
struct TimeSpan {
  double begin = 0.0, end = 0.0;
};

/// Spans in order, none empty, none overlapping.
using TimeSpans = std::vector<TimeSpan>;

/// Sorted; those that overlap or touch are joined, empty ones dropped.
TimeSpans normalized(TimeSpans spans);
TimeSpans intersection(const TimeSpans& a, const TimeSpans& b);
TimeSpans unionOf(const TimeSpans& a, const TimeSpans& b);
/// Seconds that all spans last.
double lengthOf(const TimeSpans& spans);

/// What a tracker's samples cover of a hand's work.
struct MotionCoverage {
  TimeSpans mounted;  ///< with an instrument
  TimeSpans lost;     ///< of these, without measurement

  /// 1 - |lost| / |mounted|, in [0, 1]. @return nothing where no instrument was mounted.
  [[nodiscard]] std::optional<double> share() const;
};

/// Of a part of the attempt.
MotionCoverage within(const MotionCoverage& coverage, const TimeSpans& window);
/// While both hands have an instrument; lost is what either hand lost.
MotionCoverage ofBoth(const MotionCoverage& left, const MotionCoverage& right);

}  // namespace calot::analytics
