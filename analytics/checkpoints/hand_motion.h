// SPDX-License-Identifier: GPL-3.0-or-later
// What checkpoints of the hands' motion have in common: their declarations, and how a figure of one motion becomes the
// values of both hands, or of each hand and phase.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/motion.h"
#include "analytics/checkpoints/phases.h"

namespace calot::analytics {

/// Below this (m/s) nothing moved: slower than any tracker can tell from rest.
inline constexpr double minSpeed = 1e-4;

/// A figure, or why there is none.
struct Measured {
  std::optional<double> value;
  Availability missing = Availability::notApplicable;
  std::string reason;
  std::string note;

  static Measured of(double figure, std::string note = {}) {
    return {figure, Availability::value, {}, std::move(note)};
  }
  static Measured notApplicable(std::string why) {
    return {std::nullopt, Availability::notApplicable, std::move(why), {}};
  }
  static Measured notAvailable(std::string why) {
    return {std::nullopt, Availability::notAvailable, std::move(why), {}};
  }
};

/// A figure of one motion. @pre the motion has segments.
using MotionMeasure = Measured (*)(const Motion&);

/// A declaration with all that motion checkpoints share: window, filter, origin `samples`, known at the end.
/// `aggregation` hand, SI unit shown as it is, version 1: change what differs.
CheckpointDefinition motionDefinition(const char* name, const char* title, const char* unit, Direction direction,
                                      const char* formula);

/// The value of a measure, with the motion's own filter named.
CheckpointValue motionValue(const CheckpointDefinition& definition, std::string subject, const Measured& measured,
                            double cutoff, Origin origin = Origin::samples);

/// The measure of one hand's motion, or why there is none: no instrument, nothing measured. What is missing of the
/// motion is noted.
Measured measureHand(const Motion& motion, MotionMeasure measure);

/// Greatest speed (m/s).
double maxSpeed(const Motion& motion);

/// A checkpoint that gives `measure` of each hand. @pre the definition outlives it.
std::unique_ptr<Checkpoint> perHand(const CheckpointDefinition& definition, MotionMeasure measure);

/// A checkpoint that gives `measure` of each hand in each phase: "left clipping". @pre the definition outlives it.
std::unique_ptr<Checkpoint> perHandAndPhase(const CheckpointDefinition& definition, MotionMeasure measure,
                                            const AttemptContext& context);

/// The entry of the figure of each hand in each phase, declared as phaseDefinition() of the whole attempt's says.
/// @param rank among the figures of phases
template <const CheckpointDefinition& (*whole)(), MotionMeasure measure>
CheckpointEntry phaseMotionEntry(int rank) {
  static const CheckpointDefinition d = phaseDefinition(whole(), "points");
  return {{CheckpointFamily::phases, rank}, d, [](const AttemptContext& context) {
            return perHandAndPhase(d, measure, context);
          }};
}

}  // namespace calot::analytics
