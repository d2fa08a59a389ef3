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

/// Least share of its window that samples must cover for a figure of motion.
inline constexpr double minMotionCoverage = 0.9;

/// A figure, or why there is none.
struct Measured {
  std::optional<double> value = {};
  Availability missing = Availability::notApplicable;
  std::string reason = {};
  std::string note = {};
  std::optional<double> coverage = {};  ///< MotionCoverage::share()

  static Measured of(double figure, std::string note = {}) {
    return {.value = figure, .missing = Availability::value, .note = std::move(note)};
  }
  static Measured none(Availability missing, std::string why) { return {.missing = missing, .reason = std::move(why)}; }
  static Measured notApplicable(std::string why) { return none(Availability::notApplicable, std::move(why)); }
  static Measured notAvailable(std::string why) { return none(Availability::notAvailable, std::move(why)); }
};

/// A figure of one motion. @pre the motion has segments.
using MotionMeasure = Measured (*)(const Motion&);

/// A declaration with all that motion checkpoints share: window, filter, minMotionCoverage, origin `samples`, known at
/// the end. `aggregation` hand, SI unit shown as it is, version 2: change what differs.
CheckpointDefinition motionDefinition(const char* name, const char* title, const char* unit, Direction direction,
                                      const char* formula);

/// The value of a measure, with the motion's own filter named.
CheckpointValue motionValue(const CheckpointDefinition& definition, std::string subject, const Measured& measured,
                            double cutoff, Origin origin = Origin::samples);

/// Why no figure of motions may be given: too little coverage, nothing measured. Nothing: one may.
/// @param coverage of the figure's window
std::optional<Measured> refusalOf(const CheckpointDefinition& definition, const MotionCoverage& coverage,
                                  bool hasSegments, const std::string& ofHand = {});

/// Adds the coverage to a figure, and notes time without measurement.
Measured withCoverage(Measured measured, const MotionCoverage& coverage);

/// The measure of one hand's motion, or why there is none: no instrument, too little coverage, nothing measured.
Measured measureHand(const CheckpointDefinition& definition, const Motion& motion, MotionMeasure measure);

/// Greatest speed (m/s).
double maxSpeed(const Motion& motion);

/// A checkpoint that gives `measure` of each hand. @pre the definition outlives it.
std::unique_ptr<Checkpoint> perHand(const CheckpointDefinition& definition, MotionMeasure measure);

/// A checkpoint that gives `measure` of each hand in each phase: "left clipping". @pre the definition outlives it.
std::unique_ptr<Checkpoint> perHandAndPhase(const CheckpointDefinition& definition, MotionMeasure measure,
                                            const AttemptContext& context);

/// The entry of the figure of each hand in each phase, declared as phaseDefinition() of the whole attempt's says.
/// @param rank among the figures of phases @param version of the definition, without the judgement's
template <const CheckpointDefinition& (*whole)(), MotionMeasure measure>
CheckpointEntry phaseMotionEntry(int rank, std::uint32_t version = 2) {
  static const CheckpointDefinition d = phaseDefinition(whole(), "points", version);
  return {{CheckpointFamily::phases, rank}, d, [](const AttemptContext& context) {
            return perHandAndPhase(d, measure, context);
          }};
}

}  // namespace calot::analytics
