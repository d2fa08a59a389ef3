// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of figures of the hands' motion: how a figure of one motion becomes the values of both hands, or of each hand
// and phase.
#pragma once

#include <cstdint>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/motion.h"

namespace calot::analytics {

/// Below this (m/s) nothing moved: slower than any tracker can tell from rest.
inline constexpr double minSpeed = 1e-4;

/// Least share of its window that samples must cover for a figure of motion.
inline constexpr double minMotionCoverage = 0.9;

/// A figure of one motion. @pre the motion has segments.
using MotionMeasure = Measured (*)(const Motion&);
/// A figure of both hands' motions. @pre both have segments.
using TwoHandMeasure = Measured (*)(const Motion& left, const Motion& right, const AttemptContext& context);

/// The row of `measure` of each hand. Where the row does not say otherwise: window, filter and coverage of motion; its
/// origin is `samples`, its value final.
CheckpointEntry perHand(CheckpointEntry row, MotionMeasure measure);
/// The same in each phase: "left clipping". @param whole row of the whole attempt @param rank, version as phaseRow()
CheckpointEntry perHandAndPhase(const CheckpointEntry& whole, int rank, MotionMeasure measure,
                                std::uint32_t version = 2);
/// The row of a figure of both hands together; no value where a hand has no instrument.
CheckpointEntry ofBothHands(CheckpointEntry row, TwoHandMeasure measure);

/// Greatest speed (m/s).
double maxSpeed(const Motion& motion);

}  // namespace calot::analytics
