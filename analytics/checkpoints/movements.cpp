// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/checkpoints/movements.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "analytics/checkpoints/hand_motion.h"
#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
namespace {

constexpr double fastest = 0.95;       // quantile of the speed
constexpr double movementShare = 0.5;  // of it

}  // namespace

double movementSpeedOf(const std::vector<MotionSegment>& segments) {
  const Expected<double> peak = quantile(speedsOf(segments), fastest);
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
  for (std::size_t i = begin + 1; i < end; ++i) length += lengthOf(segment.filtered[i] - segment.filtered[i - 1]);
  return length;
}

double pathLength(const Motion& motion) {
  double length = 0.0;
  for (const MotionSegment& segment : motion.segments) length += pathLength(segment, 0, segment.filtered.size());
  return length;
}

namespace {

/// Sum of term(0) to term(n - 1): eight sums side by side, added up in a fixed order: wide on every machine, the same
/// bits.
template <class Term>
double sumOf(std::size_t n, Term term) {
  double lane[8] = {};
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    for (std::size_t l = 0; l < 8; ++l) lane[l] += term(i + l);
  }
  for (std::size_t l = 0; i < n; ++i, ++l) lane[l] += term(i);
  return ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
}

double sum(const double* a, std::size_t n) {
  return sumOf(n, [a](std::size_t i) { return a[i]; });
}

double dot(const double* a, const double* b, std::size_t n, double meanA, double meanB) {
  return sumOf(n, [=](std::size_t i) { return (a[i] - meanA) * (b[i] - meanB); });
}

}  // namespace

std::vector<CommonPart> commonParts(const Motion& left, const Motion& right, std::int64_t lag) {
  std::vector<CommonPart> parts;
  for (const MotionSegment& a : left.segments) {
    for (const MotionSegment& b : right.segments) {
      const std::int64_t aEnd = a.first + static_cast<std::int64_t>(a.speed.size());
      const std::int64_t bBegin = b.first - lag, bEnd = bBegin + static_cast<std::int64_t>(b.speed.size());
      const std::int64_t begin = std::max(a.first, bBegin), end = std::min(aEnd, bEnd);
      if (begin >= end) continue;
      parts.push_back({a.speed.data() + (begin - a.first), b.speed.data() + (begin - bBegin),
                       static_cast<std::size_t>(end - begin)});
    }
  }
  return parts;
}

std::optional<double> speedCorrelation(const Motion& left, const Motion& right, std::int64_t lag) {
  const std::vector<CommonPart> parts = commonParts(left, right, lag);
  double points = 0.0, sumLeft = 0.0, sumRight = 0.0;
  for (const CommonPart& part : parts) {
    points += static_cast<double>(part.points);
    sumLeft += sum(part.left, part.points);
    sumRight += sum(part.right, part.points);
  }
  if (points < 2.0) return std::nullopt;
  const double l = sumLeft / points, r = sumRight / points;
  double ll = 0.0, rr = 0.0, lr = 0.0;
  for (const CommonPart& part : parts) {
    ll += dot(part.left, part.left, part.points, l, l);
    rr += dot(part.right, part.right, part.points, r, r);
    lr += dot(part.left, part.right, part.points, l, r);
  }
  const double least = minSpeed * minSpeed * points;
  if (!(ll > least) || !(rr > least)) return std::nullopt;
  return std::clamp(lr / (std::sqrt(ll) * std::sqrt(rr)), -1.0, 1.0);
}

std::optional<LaggedCorrelation> greatestSpeedCorrelation(const Motion& left, const Motion& right,
                                                          std::int64_t farthest) {
  std::optional<LaggedCorrelation> best;
  for (std::int64_t n = 0; n <= farthest; ++n) {
    for (const std::int64_t lag : {-n, n}) {
      const std::optional<double> c = speedCorrelation(left, right, lag);
      if (c && (!best || *c > best->correlation)) best = {*c, lag};
    }
  }
  return best;
}

}  // namespace calot::analytics
