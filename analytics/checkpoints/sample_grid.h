// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "sim/math/linear.h"

namespace calot::analytics {

/// Rate of the motion on which motion checkpoints work (Hz).
inline constexpr double motionRate = 100.0;

/// A pose at its time.
struct TimedPose {
  double time = 0.0;  ///< in the unit of the grid's times
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();  ///< unit
};

/// Poses at the points k / motionRate of one uninterrupted motion.
struct GridRun {
  std::int64_t first = 0;         ///< k of the first point
  std::vector<Vec3> position;     ///< p_WI (m)
  std::vector<Quat> orientation;  ///< q_WI, unit, each on the side of its predecessor; as many
  TimedPose begin, end;           ///< first and last sample
  bool continues = false;         ///< it goes on from the run before, after a time without samples

  /// Appends a pose at the next point. @param orientation unit, of either sign
  void append(const Vec3& p, const Quat& orientation);
};

/// Time of point k, in the unit of times of which there are so many a second; correctly rounded where that is a whole
/// number.
double gridTime(std::int64_t k, double unitsPerSecond);

/// Resamples the poses of a tracker to the grid t = k / motionRate: positions on the straight line between the samples
/// around a point, orientations (normalised) by normalised linear interpolation on the shorter arc; on a sample (within
/// a millionth of a grid interval): that sample. Nothing is extrapolated. Deterministic contract.
class SampleGrid {
 public:
  /// @param unitsPerSecond of the times that are given: 1000 for ticks, 30 for rows at 30 Hz, 1 for seconds. @pre > 0.
  explicit SampleGrid(double unitsPerSecond) : unitsPerSecond_(unitsPerSecond) {}

  /// A sample that begins a new run. @param continues GridRun::continues. @pre later than every sample before.
  void begin(double time, const Vec3& position, const Quat& orientation, bool continues = false);
  /// A sample that goes on from the one before it. @pre as begin(), and there was one.
  void extend(double time, const Vec3& position, const Quat& orientation);

  [[nodiscard]] const std::vector<GridRun>& runs() const { return runs_; }
  [[nodiscard]] std::vector<GridRun> takeRuns() && { return std::move(runs_); }
  [[nodiscard]] double unitsPerSecond() const { return unitsPerSecond_; }

 private:
  void put(const Vec3& position, const Quat& orientation);

  double unitsPerSecond_;
  std::int64_t next_ = 0;
  std::vector<GridRun> runs_;
};

}  // namespace calot::analytics
