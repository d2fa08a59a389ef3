// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/hand_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "analytics/checkpoints/motion.h"

namespace calot::analytics {
namespace {

class PerHand final : public Checkpoint {
 public:
  PerHand(const CheckpointDefinition& definition, MotionMeasure measure) : definition_(definition), measure_(measure) {}

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    std::vector<CheckpointValue> result;
    for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h) {
      const Motion& motion = *end.motion[h];
      result.push_back(
          motionValue(definition_, handNames[h], measureHand(definition_, motion, measure_), motion.cutoff));
    }
    return result;
  }

 private:
  const CheckpointDefinition& definition_;
  MotionMeasure measure_;
};

class PerHandAndPhase final : public Checkpoint {
 public:
  PerHandAndPhase(const CheckpointDefinition& definition, MotionMeasure measure, const AttemptContext& context)
      : definition_(definition), measure_(measure), notApplicable_(whyNoPhases(context)) {}

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!notApplicable_.empty())
      return {makeMissing(definition_, "", end.origin, Availability::notApplicable, notApplicable_)};
    std::vector<CheckpointValue> result;
    for (const PhaseMotion& phase : *end.phases) {
      for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h) {
        const Motion& motion = phase.motion[h];
        const Measured measured =
            phase.seconds > 0.0 ? measureHand(definition_, motion, measure_) : Measured::notApplicable(noSuchPhase);
        result.push_back(motionValue(definition_, handAndPhase(h, phase.phase), measured, motion.cutoff, end.origin));
      }
    }
    return result;
  }

 private:
  const CheckpointDefinition& definition_;
  MotionMeasure measure_;
  std::string notApplicable_;
};

}  // namespace

CheckpointDefinition motionDefinition(const char* name, const char* title, const char* unit, Direction direction,
                                      const char* formula) {
  return {
      .name = name,
      .title = title,
      .unit = unit,
      .displayUnit = unit,
      .displayFactor = 1.0,
      .direction = direction,
      .window = "whole attempt, while an instrument is mounted and measured",
      .aggregation = Aggregation::hand,
      .instruments = "each hand by itself",
      .filter = motionFilterText(),
      .minCoverage = minMotionCoverage,
      .origins = {Origin::samples},
      .finality = Finality::final,
      .version = 2,
      .definition = formula,
      .paperReading = "",
  };
}

CheckpointValue motionValue(const CheckpointDefinition& definition, std::string subject, const Measured& measured,
                            double cutoff, Origin origin) {
  CheckpointValue value = measured.value
                              ? makeValue(definition, std::move(subject), origin, *measured.value, measured.note)
                              : makeMissing(definition, std::move(subject), origin, measured.missing, measured.reason);
  if (cutoff != motionCutoff && definition.filter == motionFilterText()) value.filter = motionFilterText(cutoff);
  value.coverage = measured.coverage;
  return value;
}

std::optional<Measured> refusalOf(const CheckpointDefinition& definition, const MotionCoverage& coverage,
                                  bool hasSegments, const std::string& ofHand) {
  const double share = coverage.share().value_or(0.0);
  if (share < definition.minCoverage) {
    return Measured::none(Availability::tooLittleCoverage,
                          fmt::format("samples cover {:.1f} % of the time; {:g} % are wanted", 100.0 * share,
                                      100.0 * definition.minCoverage));
  }
  if (!hasSegments) return Measured::notAvailable(fmt::format("no measured motion of 0.1 s or longer{}", ofHand));
  return std::nullopt;
}

Measured withCoverage(Measured measured, const MotionCoverage& coverage) {
  measured.coverage = coverage.share();
  const double lost = lengthOf(coverage.lost);
  if (measured.value && lost > straightBridge)
    measured.note += fmt::format("{}{:.3f} s without measurement", measured.note.empty() ? "" : "; ", lost);
  return measured;
}

Measured measureHand(const CheckpointDefinition& definition, const Motion& motion, MotionMeasure measure) {
  if (!motion.coverage.share()) return Measured::none(Availability::absentHand, "no instrument in this hand");
  std::optional<Measured> refusal = refusalOf(definition, motion.coverage, !motion.segments.empty());
  return withCoverage(refusal ? *std::move(refusal) : measure(motion), motion.coverage);
}

double maxSpeed(const Motion& motion) {
  double largest = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    for (const double v : segment.speed) largest = std::max(largest, v);
  }
  return largest;
}

std::unique_ptr<Checkpoint> perHand(const CheckpointDefinition& definition, MotionMeasure measure) {
  return std::make_unique<PerHand>(definition, measure);
}

std::unique_ptr<Checkpoint> perHandAndPhase(const CheckpointDefinition& definition, MotionMeasure measure,
                                            const AttemptContext& context) {
  return std::make_unique<PerHandAndPhase>(definition, measure, context);
}

}  // namespace calot::analytics
