// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of figures of the hands' motion: how a figure of one motion becomes the values of both hands, or of each hand
// and phase. Stretches of a motion by the speed of the tip: movements, and rest between them; both hands' speeds
// together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

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
                                std::uint32_t version = 3);
/// The row of a figure of both hands together; no value where a hand has no instrument.
CheckpointEntry ofBothHands(CheckpointEntry row, TwoHandMeasure measure);

/// Greatest speed (m/s).
double maxSpeed(const Motion& motion);

/// A movement: speed of at least movementSpeedOf() for at least so long (s).
inline constexpr double movementTime = 0.2;
/// Idle: speed below so much (m/s) for at least so long (s).
inline constexpr double idleSpeed = 0.005;
inline constexpr double idleTime = 0.5;

/// Threshold of a hand's movements (m/s): half of the 95th percentile (type 7) of its speed, at least idleSpeed. A
/// fixed one finds no movement of slow hands, and only one in all that fast hands do.
double movementSpeedOf(const std::vector<MotionSegment>& segments);

/// Points [begin, end) of a segment.
struct Stretch {
  std::size_t begin = 0, end = 0;
  [[nodiscard]] std::size_t points() const { return end - begin; }
};

/// Minimum number of points of a stretch of this length (s): each stands for 1 / motionRate.
std::size_t pointsOf(double seconds);

/// Maximal runs of points that are all `true`, of at least `least` points.
std::vector<Stretch> stretchesOf(const std::vector<bool>& points, std::size_t least);

/// "threshold 21.3 mm/s", and why a motion has no movement.
std::string thresholdNote(const Motion& motion);
std::string noMovement(const Motion& motion);

/// Movements of a segment, in order: from the magnitude of the velocity, whatever its direction.
/// @param threshold Motion::movementSpeed
std::vector<Stretch> movementsOf(const MotionSegment& segment, double threshold);

/// Length of the way over the filtered points [begin, end) (m).
double pathLength(const MotionSegment& segment, std::size_t begin, std::size_t end);
/// The same over all segments.
double pathLength(const Motion& motion);

/// A stretch of the grid in which both hands are measured, the right one `lag` points later: speed i of the left hand
/// beside that of the right hand `lag` points after it. Views into the motions.
struct CommonPart {
  const double* left = nullptr;
  const double* right = nullptr;
  std::size_t points = 0;
};
std::vector<CommonPart> commonParts(const Motion& left, const Motion& right, std::int64_t lag);

/// Pearson's correlation of both hands' speeds, the right one taken `lag` points later.
struct LaggedCorrelation {
  double correlation = 0.0;
  std::int64_t lag = 0;
};
/// At lag 0. @return nothing where there are fewer than 2 common points or a speed does not vary by minSpeed, or by
/// less than the tracker's noise.
std::optional<double> speedCorrelation(const Motion& left, const Motion& right, std::int64_t lag = 0);
/// The greatest within +-`farthest` points; the smallest lag of equals, the negative one first.
std::optional<LaggedCorrelation> greatestSpeedCorrelation(const Motion& left, const Motion& right,
                                                          std::int64_t farthest);

}  // namespace calot::analytics
