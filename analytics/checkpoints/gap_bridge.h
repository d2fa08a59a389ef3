// SPDX-License-Identifier: GPL-3.0-or-later
// What is made of times without samples: which are gaps, which are bridged, and how.
#pragma once

#include <vector>

#include "analytics/checkpoints/sample_grid.h"

namespace calot::analytics {

/// Samples this close (s) are joined by a straight line whatever the tracker's interval; sources repeat a pose for as
/// long.
inline constexpr double straightBridge = 0.1;
/// A gap: more than so many of the tracker's own intervals between two samples.
inline constexpr double gapIntervals = 2.5;
/// More lost time (s) is not bridged: the motion falls into two segments.
inline constexpr double maxBridge = 1.0;

/// How a time between two samples is taken, by the tracker's own interval.
class GapRule {
 public:
  /// @param interval SampleRate::interval() (s); 0: not known
  explicit GapRule(double interval) : interval_(interval) {}

  /// Longest time between two samples that is no gap (s).
  [[nodiscard]] double longestEven() const { return gapIntervals * interval_; }
  [[nodiscard]] bool isGap(double seconds) const { return seconds > longestEven(); }
  /// Of a gap: what no sample covers, each covering one interval.
  [[nodiscard]] double lost(double seconds) const { return seconds - interval_; }
  /// Joined by a straight line.
  [[nodiscard]] bool isStraight(double seconds) const { return seconds <= straightBridge || !isGap(seconds); }
  /// Joined, by a straight line or a curve.
  [[nodiscard]] bool isBridged(double seconds) const { return isStraight(seconds) || lost(seconds) <= maxBridge; }
  [[nodiscard]] double interval() const { return interval_; }

 private:
  double interval_;
};

/// Joins runs to those that they continue, where the rule bridges the time between them. Straight: as SampleGrid.
/// Curved: positions on the cubic Hermite curve through both samples,
///
///   p(s) = (2 s^3 - 3 s^2 + 1) p_0 + (s^3 - 2 s^2 + s) h v_0 + (3 s^2 - 2 s^3) p_1 + (s^3 - s^2) h v_1,  s = (t - t_0)
///   / h,
///
/// v_0 and v_1 the least-squares slopes of the motion over the 0.1 s (or one of the tracker's intervals, if longer)
/// before and after it, the chord's where fewer than two points are there; orientations by normalised linear
/// interpolation. Deterministic contract.
std::vector<GridRun> bridged(std::vector<GridRun> runs, const GapRule& rule, double unitsPerSecond);

}  // namespace calot::analytics
