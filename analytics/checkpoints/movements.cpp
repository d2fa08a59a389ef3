// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/movements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
namespace {

constexpr double fastest = 0.95;       // quantile of the speed
constexpr double movementShare = 0.5;  // of it

}  // namespace

double movementSpeedOf(const std::vector<MotionSegment>& segments) {
  std::vector<double> speed;
  for (const MotionSegment& segment : segments) speed.insert(speed.end(), segment.speed.begin(), segment.speed.end());
  const Expected<double> peak = quantile(speed, fastest);
  return std::max(peak ? movementShare * *peak : 0.0, idleSpeed);
}

std::size_t pointsOf(double seconds) { return static_cast<std::size_t>(std::floor(seconds * motionRate + 0.5)); }

std::vector<Stretch> stretchesOf(const std::vector<bool>& points, std::size_t least) {
  std::vector<Stretch> result;
  for (std::size_t begin = 0; begin < points.size();) {
    if (!points[begin]) {
      ++begin;
      continue;
    }
    std::size_t end = begin;
    while (end < points.size() && points[end]) ++end;
    if (end - begin >= least) result.push_back({begin, end});
    begin = end;
  }
  return result;
}

std::string thresholdNote(const Motion& motion) {
  return fmt::format("threshold {:.1f} mm/s", 1000.0 * motion.movementSpeed);
}

std::string noMovement(const Motion& motion) {
  return fmt::format("no movement of {:.1f} mm/s for {:g} s", 1000.0 * motion.movementSpeed, movementTime);
}

std::vector<Stretch> movementsOf(const MotionSegment& segment, double threshold) {
  std::vector<bool> fast(segment.speed.size());
  for (std::size_t i = 0; i < fast.size(); ++i) fast[i] = segment.speed[i] >= threshold;
  return stretchesOf(fast, pointsOf(movementTime));
}

double pathLength(const MotionSegment& segment, std::size_t begin, std::size_t end) {
  double length = 0.0;
  for (std::size_t i = begin + 1; i < end; ++i) {
    const double dx = segment.filtered[i].x() - segment.filtered[i - 1].x();
    const double dy = segment.filtered[i].y() - segment.filtered[i - 1].y();
    const double dz = segment.filtered[i].z() - segment.filtered[i - 1].z();
    length += std::sqrt(dx * dx + dy * dy + dz * dz);
  }
  return length;
}

double pathLength(const Motion& motion) {
  double length = 0.0;
  for (const MotionSegment& segment : motion.segments) length += pathLength(segment, 0, segment.filtered.size());
  return length;
}

}  // namespace calot::analytics
