// SPDX-License-Identifier: GPL-3.0-or-later
// Smoothness of the tip's motion: spectral arc length, and log dimensionless jerk of the whole and of its movements.
#include "analytics/checkpoints/smoothness.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "analytics/checkpoints/figures/rows.h"
#include "analytics/checkpoints/hand_motion.h"

namespace calot::analytics {
namespace {

/// Shorter segments (s) say nothing of a band that begins near 0 Hz.
constexpr double minSegment = 1.0;
/// SPARC's upper frequency follows the spectrum's tail, which a bridge lowers, a long one more than short ones that
/// lose as much (s): docs/reference/metrics/samples.md has the simulation.
constexpr double minSparcCoverage = 0.95, maxSparcBridge = 0.5;

using OfSpeed = std::optional<double> (*)(std::span<const double>, double);

/// A figure of the whole speed profile depends on its length: averaged over pieces between gaps, it would count gaps.
bool isBroken(const Motion& motion) {
  return std::any_of(motion.segments.begin(), motion.segments.end(),
                     [](const MotionSegment& segment) { return segment.continues; });
}

Measured refusedForAGap(double seconds) {
  return Measured::none(Availability::tooLittleCoverage,
                        fmt::format("a gap without samples of more than {:g} s", seconds));
}

/// The longest time without samples that a bridge fills (s); what is lost before or after a segment is in no figure.
double longestBridge(const Motion& motion) {
  double longest = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    const double begin = static_cast<double>(segment.first) / motionRate;
    const double end = begin + static_cast<double>(segment.speed.size()) / motionRate;
    for (const TimeSpan& lost : motion.coverage.lost) {
      if (lost.begin > begin && lost.end < end) longest = std::max(longest, lost.end - lost.begin);
    }
  }
  return longest;
}

Measured ofLongSegments(const Motion& motion, OfSpeed figure) {
  if (isBroken(motion)) return refusedForAGap(maxBridge);
  const double least = std::max(minSpeed, 2.0 * restSpeed(motion));
  if (maxSpeed(motion) < least)
    return Measured::notApplicable(fmt::format("the hand did not move: no speed of {:.1f} mm/s", 1000.0 * least));
  double sum = 0.0, points = 0.0;
  std::size_t segments = 0;
  for (const MotionSegment& segment : motion.segments) {
    if (segment.speed.size() < pointsOf(minSegment)) continue;
    const std::optional<double> value = figure(segment.speed, motionRate);
    if (!value) continue;
    sum += *value * static_cast<double>(segment.speed.size());
    points += static_cast<double>(segment.speed.size());
    ++segments;
  }
  if (segments == 0) return Measured::notAvailable("no measured motion of 1 s or longer");
  return Measured::of(sum / points, segments > 1 ? fmt::format("mean of {} segments", segments) : "");
}

std::string tooSlow(const Motion& motion, double wanted) {
  if (motion.interval == 0.0 && maxSpeed(motion) < minSpeed) return {};
  const double rate = motion.interval > 0.0 ? 1.0 / motion.interval : 0.0;
  if (rate >= wanted) return {};
  return fmt::format("effective rate {:.1f} Hz; {:g} Hz is wanted", rate,
                     wanted < 30.0 && wanted > 29.0 ? 30.0 : wanted);
}

Measured sparc(const Motion& motion) {
  // Slower samples say nothing of frequencies up to 10 Hz.
  if (std::string why = tooSlow(motion, 2.0 * sparcHighest); !why.empty())
    return Measured::notAvailable(std::move(why));
  if (!isBroken(motion) && longestBridge(motion) > maxSparcBridge) return refusedForAGap(maxSparcBridge);
  return ofLongSegments(motion, spectralArcLength);
}

/// At a segment's ends the filter mirrors the motion and differences are one-sided: a steady motion has its only jerk
/// there. Steady: a quarter of a second from both ends, the speed varies by less than can be measured.
/// @pre a segment lasts for minSegment
bool isSteady(const Motion& motion) {
  const auto ends = static_cast<std::ptrdiff_t>(pointsOf(0.25));
  const double least = std::max(minSpeed, 2.0 * restSpeed(motion));
  return std::all_of(motion.segments.begin(), motion.segments.end(), [&](const MotionSegment& segment) {
    if (segment.speed.size() < pointsOf(minSegment)) return true;
    const auto [low, high] = std::minmax_element(segment.speed.begin() + ends, segment.speed.end() - ends);
    return *high - *low < least;
  });
}

Measured jerk(const Motion& motion) {
  if (std::string why = tooSlow(motion, minJerkRate); !why.empty()) return Measured::notAvailable(std::move(why));
  Measured measured = ofLongSegments(motion, logDimensionlessJerk);
  if (measured.value && isSteady(motion))
    return Measured::notApplicable("the speed is steady: its jerk is an effect of the recording's ends");
  return measured;
}

/// A movement with its beginning and end: cut off at the threshold it would seem smoother than any movement can be.
Stretch widened(const std::vector<double>& speed, Stretch movement) {
  while (movement.begin > 0 && speed[movement.begin - 1] < speed[movement.begin] &&
         speed[movement.begin - 1] >= idleSpeed)
    --movement.begin;
  while (movement.end < speed.size() && speed[movement.end] < speed[movement.end - 1] &&
         speed[movement.end] >= idleSpeed)
    ++movement.end;
  return movement;
}

Measured jerkOfMovements(const Motion& motion) {
  if (std::string why = filledByNoise(motion, motion.movementSpeed); !why.empty())
    return Measured::notAvailable(std::move(why));
  if (std::string why = tooSlow(motion, minJerkRate); !why.empty()) return Measured::notAvailable(std::move(why));
  double sum = 0.0;
  std::size_t movements = 0;
  for (const MotionSegment& segment : motion.segments) {
    for (const Stretch& movement : movementsOf(segment, motion.movementSpeed)) {
      const Stretch whole = widened(segment.speed, movement);
      const std::span<const double> speed(segment.speed.data() + whole.begin, whole.points());
      const std::optional<double> value = logDimensionlessJerk(speed, motionRate);
      if (!value) continue;
      sum += *value;
      ++movements;
    }
  }
  if (movements == 0) return Measured::notApplicable(noMovement(motion));
  return Measured::of(sum / static_cast<double>(movements), fmt::format("{} movements", movements));
}

}  // namespace

std::vector<CheckpointEntry> smoothnessRows() {
  const CheckpointEntry arc = perHand(
      {.place = {CheckpointFamily::motion, 100},
       .definition = {.name = "sparc",
                      .title = "Spectral arc length (SPARC)",
                      .direction = Direction::higher,
                      .minCoverage = minSparcCoverage,
                      .domain = Domain::any,
                      .version = 4,
                      .definition = "-sum sqrt((df / (fc - f0))^2 + dM^2) from f0 to fc, the first and last frequency, "
                                    "at most 10 Hz, with M >= 0.05; M the amplitude spectrum of v as a share of M(0 "
                                    "Hz), zeros added up to 2^(ceil(log2 n) + 4) values; v as in speed-mean; of "
                                    "segments of 1 s or longer, averaged by their length; bridged gaps lose at most "
                                    "0.5 s each"}},
      sparc);
  const CheckpointEntry whole = perHand(
      {.place = {CheckpointFamily::motion, 110},
       .definition = {.name = "log-dimensionless-jerk",
                      .title = "Log dimensionless jerk (LDLJ of the speed profile)",
                      .direction = Direction::higher,
                      .domain = Domain::any,
                      .version = 3,
                      .definition = "-ln(T^3 / v_peak^2 * sum (v'')^2 dt), v'' = (v(k+1) - 2 v(k) + v(k-1)) / dt^2, T "
                                    "= n dt, v as in speed-mean; of segments of 1 s or longer, averaged by their "
                                    "length; not of a steady speed, which varies by less than 0.1 mm/s between the "
                                    "segments' first and last quarter second"}},
      jerk);
  const CheckpointEntry movements = perHand(
      {.place = {CheckpointFamily::motion, 120},
       .definition = {.name = "movement-jerk",
                      .title = "Log dimensionless jerk of a movement (mean)",
                      .direction = Direction::higher,
                      .domain = Domain::any,
                      .version = 3,
                      .definition = "mean over movements of log-dimensionless-jerk of each; movements as in movements, "
                                    "and outwards to where v stops falling or falls below 5 mm/s"}},
      jerkOfMovements);
  return {arc, perHandAndPhase(arc, 80, sparc, 4), whole, perHandAndPhase(whole, 90, jerk), movements};
}

}  // namespace calot::analytics
