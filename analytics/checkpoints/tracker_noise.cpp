// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/checkpoints/tracker_noise.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "analytics/checkpoints/motion.h"
#include "analytics/statistics/descriptive.h"
#include "sim/math/no_fused_pairs.h"  // first

namespace calot::analytics {
namespace {

constexpr double windowSeconds = 0.5;  ///< s
constexpr std::size_t minDifferences = 12;
/// Deviations of the speed's components that its magnitude passes in one of four hundred points (chi-squared, three
/// degrees of freedom): idle time of just so much noise reads 5 % short.
constexpr double restDeviations = 3.8;

}  // namespace

void TrackerNoise::add(double time, const Vec3& position) {
  if (known_ > 0 && (position == newest_.back().position || time - newest_.back().time > straightBridge)) known_ = 0;
  std::rotate(newest_.begin(), newest_.begin() + 1, newest_.end());
  newest_.back() = {time, position};
  known_ = std::min(known_ + 1, samples);
  if (known_ < samples) return;
  if (count_ == 0) windowBegin_ = newest_[0].time;
  Vec3 difference = Vec3::Zero();
  double weights = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    double w = 1.0;
    for (std::size_t j = 0; j < samples; ++j) {
      if (j != i) w /= newest_[i].time - newest_[j].time;
    }
    difference += w * (newest_[i].position - newest_[0].position);
    weights += w * w;
  }
  const double length = lengthOf(difference);
  sum_ += length * length / (3.0 * weights);
  if (++count_ < minDifferences || time - windowBegin_ < windowSeconds) return;
  windows_.push_back(sum_ / static_cast<double>(count_));
  sum_ = 0.0;
  count_ = 0;
}

std::optional<double> TrackerNoise::deviation() const {
  const Expected<double> quiet = quantile(windows_, 0.25);
  return quiet ? std::optional(std::sqrt(*quiet)) : std::nullopt;
}

double speedNoise(const Motion& motion) {
  const double interval = std::max(motion.interval, 1.0 / motionRate);
  const double band = motion.cutoff * motion.cutoff * motion.cutoff * interval;
  return 2.0 * std::numbers::pi * motion.noise.value_or(0.0) *
         std::sqrt(std::numbers::pi / (4.0 * std::numbers::sqrt2) * band);
}

double restSpeed(const Motion& motion) { return restDeviations * speedNoise(motion); }

std::string filledByNoise(const Motion& motion, double threshold) {
  if (restSpeed(motion) <= threshold) return {};
  return fmt::format("noise of {:.2f} mm at {:.1f} Hz reaches {:.1f} mm/s, the threshold is {:.1f} mm/s",
                     1000.0 * motion.noise.value_or(0.0), motion.rate, 1000.0 * restSpeed(motion), 1000.0 * threshold);
}

}  // namespace calot::analytics
