// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/checkpoints/hand_motion.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "analytics/checkpoints/figures/rows.h"
#include "analytics/checkpoints/phases.h"
#include "analytics/statistics/descriptive.h"
#include "recorder/base/counted.h"

namespace calot::analytics {
namespace {

/// Explains why no figure of motions may be given: too little coverage, nothing measured. Empty: one may.
/// @param coverage of the figure's window
std::optional<Measured> refusalOf(double minCoverage, const MotionCoverage& coverage, bool hasSegments,
                                  const std::string& ofHand = {}) {
  const double share = coverage.share().value_or(0.0);
  if (share < minCoverage) {
    return Measured::none(
        Availability::tooLittleCoverage,
        fmt::format("samples cover {:.1f} % of the time; {:g} % are wanted", 100.0 * share, 100.0 * minCoverage));
  }
  if (!hasSegments) return Measured::notAvailable(fmt::format("no measured motion of 0.1 s or longer{}", ofHand));
  return std::nullopt;
}

/// Adds coverage, rate and noise to a figure, and notes time without measurement.
Measured withSampling(Measured measured, const MotionCoverage& coverage, const Motion& one, const Motion& other) {
  measured.coverage = coverage.share();
  if (measured.coverage && one.rate > 0.0 && other.rate > 0.0) measured.rate = std::min(one.rate, other.rate);
  if (measured.coverage && one.noise && other.noise) measured.noise = std::max(one.noise, other.noise);
  const double lost = lengthOf(coverage.lost);
  if (measured.value && lost > straightBridge)
    measured.note += fmt::format("{}{:.3f} s without measurement", measured.note.empty() ? "" : "; ", lost);
  const std::size_t leftOut = &one == &other ? one.leftOut : one.leftOut + other.leftOut;
  if (measured.value && leftOut > 0)
    measured.note +=
        fmt::format("{}{} left out", measured.note.empty() ? "" : "; ", recorder::counted(leftOut, "sample"));
  return measured;
}

/// The measure of one hand's motion, or the reason why it is missing: no instrument, too little coverage, nothing
/// measured.
Measured measureHand(double minCoverage, const Motion& motion, MotionMeasure measure) {
  if (!motion.coverage.share()) return Measured::none(Availability::absentHand, "no instrument in this hand");
  std::optional<Measured> refusal = refusalOf(minCoverage, motion.coverage, !motion.segments.empty());
  return withSampling(refusal ? *std::move(refusal) : measure(motion), motion.coverage, motion, motion);
}

struct HandMotion {
  MotionMeasure measure;

  /// The figure of a hand, or of a hand in a phase.
  [[nodiscard]] Measured figure(const AttemptEnd& end, std::size_t subject,
                                const CheckpointDefinition& declared) const {
    const std::size_t hand = subject % handCount;
    const bool inPhase = declared.aggregation == Aggregation::handAndPhase;
    return measureHand(declared.minCoverage,
                       inPhase ? (*end.phases)[subject / handCount].motion[hand] : *end.motion[hand], measure);
  }
};

struct BothHands {
  const AttemptContext& context;
  TwoHandMeasure measure;

  [[nodiscard]] Measured figure(const AttemptEnd& end, std::size_t /*subject*/,
                                const CheckpointDefinition& declared) const {
    const Motion &left = *end.motion[0], &right = *end.motion[1];
    for (std::size_t h = 0; h < end.motion.size(); ++h) {
      if (!end.motion[h]->mounted)
        return Measured::none(Availability::absentHand, fmt::format("no instrument in the {} hand", handNames[h]));
    }
    const MotionCoverage coverage = ofBoth(left.coverage, right.coverage);
    for (std::size_t h = 0; h < end.motion.size(); ++h) {
      if (std::optional<Measured> refusal = refusalOf(declared.minCoverage, coverage, !end.motion[h]->segments.empty(),
                                                      fmt::format(" of the {} hand", handNames[h])))
        return withSampling(*std::move(refusal), coverage, left, right);
    }
    return withSampling(measure(left, right, context), coverage, left, right);
  }
};

CheckpointEntry ofMotion(CheckpointEntry row, Aggregation aggregation, const char* window, const char* instruments) {
  CheckpointDefinition& d = row.definition;
  if (d.window.empty()) d.window = window;
  d.aggregation = aggregation;
  if (d.instruments.empty()) d.instruments = instruments;
  if (d.filter.empty()) d.filter = motionFilterText();
  if (d.minCoverage == 0.0) d.minCoverage = minMotionCoverage;
  d.origins = {Origin::samples};
  d.finality = Finality::final;
  return row;
}

}  // namespace

CheckpointEntry perHand(CheckpointEntry row, MotionMeasure measure) {
  row = ofMotion(std::move(row), Aggregation::hand, "whole attempt, while an instrument is mounted and measured",
                 "each hand by itself");
  row.accumulate = accumulating<HandMotion>(measure);
  return row;
}

CheckpointEntry perHandAndPhase(const CheckpointEntry& whole, int rank, MotionMeasure measure, std::uint32_t version) {
  return phaseRow(whole, rank, "points", accumulating<HandMotion>(measure), version);
}

CheckpointEntry ofBothHands(CheckpointEntry row, TwoHandMeasure measure) {
  row = ofMotion(std::move(row), Aggregation::attempt, "whole attempt, while both hands are mounted and measured",
                 "both hands together");
  row.accumulate = accumulating<BothHands>(measure);
  return row;
}

double maxSpeed(const Motion& motion) {
  const std::vector<double> speeds = speedsOf(motion.segments);
  return speeds.empty() ? 0.0 : std::max(0.0, *std::max_element(speeds.begin(), speeds.end()));
}

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
  const auto varies = [points](double squares, const Motion& motion) {
    const double least = std::max(minSpeed, speedNoise(motion));
    return squares > least * least * points;
  };
  if (!varies(ll, left) || !varies(rr, right)) return std::nullopt;
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
