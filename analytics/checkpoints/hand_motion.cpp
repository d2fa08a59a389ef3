// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/hand_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "analytics/checkpoints/figures/rows.h"
#include "analytics/checkpoints/phases.h"

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

/// Adds the coverage to a figure, and notes time without measurement.
Measured withCoverage(Measured measured, const MotionCoverage& coverage) {
  measured.coverage = coverage.share();
  const double lost = lengthOf(coverage.lost);
  if (measured.value && lost > straightBridge)
    measured.note += fmt::format("{}{:.3f} s without measurement", measured.note.empty() ? "" : "; ", lost);
  return measured;
}

/// The measure of one hand's motion, or the reason why it is missing: no instrument, too little coverage, nothing
/// measured.
Measured measureHand(double minCoverage, const Motion& motion, MotionMeasure measure) {
  if (!motion.coverage.share()) return Measured::none(Availability::absentHand, "no instrument in this hand");
  std::optional<Measured> refusal = refusalOf(minCoverage, motion.coverage, !motion.segments.empty());
  return withCoverage(refusal ? *std::move(refusal) : measure(motion), motion.coverage);
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
        return withCoverage(*std::move(refusal), coverage);
    }
    return withCoverage(measure(left, right, context), coverage);
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

}  // namespace calot::analytics
