// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/two_hands.h"

#include <algorithm>
#include <cmath>

#include "analytics/checkpoints/hand_motion.h"

namespace calot::analytics {
namespace {

/// Eight sums side by side, added up in a fixed order: wide on every machine, the same bits.
double dot(const double* a, const double* b, std::size_t n, double meanA, double meanB) {
  double lane[8] = {};
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    for (std::size_t l = 0; l < 8; ++l) lane[l] += (a[i + l] - meanA) * (b[i + l] - meanB);
  }
  for (std::size_t l = 0; i < n; ++i, ++l) lane[l] += (a[i] - meanA) * (b[i] - meanB);
  return ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
}

double sum(const double* a, std::size_t n) {
  double lane[8] = {};
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    for (std::size_t l = 0; l < 8; ++l) lane[l] += a[i + l];
  }
  for (std::size_t l = 0; i < n; ++i, ++l) lane[l] += a[i];
  return ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
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
