// SPDX-License-Identifier: GPL-3.0-or-later
// Noise of a tracker, estimated from a recording's own samples, and the speed that it leaves behind the motion filter.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/math/linear.h"

namespace calot::analytics {

/// Standard deviation of a tracker's positions about the hand's, on each axis, from fifth divided differences of six
/// samples in a row, d = sum w_i p_i with w_i = 1 / prod_j (t_i - t_j): a motion of frequency f keeps about
/// (2 sin(pi f / rate))^5 / sqrt(252) of its amplitude in the estimate (2 % of 4 Hz at 30 Hz), white noise all of its
/// deviation s, E|d|^2 = 3 s^2 sum w_i^2. The estimate is the lower quartile of the means over windows of half a second
/// (at least 12 differences): the times at which the hand is quiet. A repeated position is no sample. Noise that the
/// tracker smoothed itself reads too low. Deterministic contract.
class TrackerNoise {
 public:
  /// Forgets the samples before: the motion is interrupted.
  void interrupt() { known_ = 0; }
  /// @param time (s), later than before. @param position (m)
  void add(double time, const Vec3& position);

  /// (m); nothing for less than one window.
  [[nodiscard]] std::optional<double> deviation() const;

 private:
  struct Sample {
    double time = 0.0;
    Vec3 position = Vec3::Zero();
  };
  static constexpr std::size_t samples = 6;  ///< of a difference
  std::array<Sample, samples> newest_;
  std::size_t known_ = 0;  ///< of `newest_`, the last ones
  double windowBegin_ = 0.0;
  double sum_ = 0.0;  ///< estimates of the variance in this window (m^2)
  std::size_t count_ = 0;
  std::vector<double> windows_;  ///< means of the full ones
};

struct Motion;

/// Standard deviation of each component of a resting hand's speed behind resampling, filter and differences (m/s):
/// s sqrt(2 T integral (2 pi f)^2 |H(f)|^2 df) = 2 pi s sqrt(pi / (4 sqrt 2) fc^3 T), H both passes of the filter with
/// cut-off fc, T the tracker's interval, at least the grid's.
double speedNoise(const Motion& motion);

/// Speed (m/s) that a resting hand reaches in a tracker's noise. A threshold below it is filled by noise
/// (docs/reference/metrics/samples.md, Noise).
double restSpeed(const Motion& motion);

/// "noise of 0.20 mm at 30.0 Hz reaches 8.2 mm/s, the threshold is 5.0 mm/s" where a threshold (m/s) is filled by
/// noise; else empty.
std::string filledByNoise(const Motion& motion, double threshold);

}  // namespace calot::analytics
