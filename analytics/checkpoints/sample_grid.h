// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "sim/math/linear.h"

namespace calot::analytics {

/// Rate of the motion on which motion checkpoints work (Hz).
inline constexpr double motionRate = 100.0;

/// Poses at the points k / motionRate of one uninterrupted motion.
struct GridRun {
  std::int64_t first = 0;         ///< k of the first point
  std::vector<Vec3> position;     ///< p_WI (m)
  std::vector<Quat> orientation;  ///< q_WI, unit, each on the side of its predecessor; as many
};

/// Resamples the poses of a tracker to the grid t = k / motionRate: positions on the straight line between the samples
/// around a point, orientations (normalised) by normalised linear interpolation on the shorter arc; on a sample (within
/// a millionth of a grid interval): that sample. Nothing is extrapolated. Deterministic contract.
class SampleGrid {
 public:
  /// @param unitsPerSecond of the times that are given: 1000 for ticks, 30 for rows at 30 Hz, 1 for seconds. @pre > 0.
  explicit SampleGrid(double unitsPerSecond) : unitsPerSecond_(unitsPerSecond) {}

  /// A sample that begins a new run. @pre later than every sample before.
  void begin(double time, const Vec3& position, const Quat& orientation);
  /// A sample that goes on from the one before it. @pre as begin(), and there was one.
  void extend(double time, const Vec3& position, const Quat& orientation);

  [[nodiscard]] const std::vector<GridRun>& runs() const { return runs_; }
  [[nodiscard]] std::vector<GridRun> takeRuns() && { return std::move(runs_); }
  /// Time of point k, in the unit of the times; correctly rounded where unitsPerSecond is a whole number.
  [[nodiscard]] double timeOf(std::int64_t k) const { return static_cast<double>(k) * unitsPerSecond_ / motionRate; }

 private:
  void put(const Vec3& position, const Quat& orientation);

  double unitsPerSecond_;
  double lastTime_ = 0.0;
  Vec3 lastPosition_ = Vec3::Zero();
  Quat lastOrientation_ = Quat::Identity();
  std::int64_t next_ = 0;
  std::vector<GridRun> runs_;
};

}  // namespace calot::analytics
