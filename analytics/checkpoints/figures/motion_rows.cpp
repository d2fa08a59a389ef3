// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of the real tip of each hand, and of both hands together.
#include "analytics/checkpoints/hand_motion.h"
#include "sim/math/no_fused_pairs.h"  // first

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "analytics/checkpoints/figures/rows.h"
#include "analytics/statistics/descriptive.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"

namespace calot::analytics {
namespace {

constexpr double minPath = 1e-3;           ///< m
constexpr std::int64_t farthestLag = 100;  ///< points: 1 s
constexpr const char* tooStill =
    "the speed of a hand does not vary by 0.1 mm/s, or by no more than the tracker's noise, while both are measured";

/// Path (m) of a resting hand in the tracker's noise: the mean of its speed's magnitude, 2 sqrt(2 / pi) deviations.
double noisePath(const Motion& motion) {
  constexpr double meanDeviations = 1.5957691216057308;
  return meanDeviations * speedNoise(motion) * static_cast<double>(motion.points()) / motionRate;
}

Measured unlessNoise(double path, double ofNoise) {
  if (path >= 2.0 * ofNoise || ofNoise < minPath) return Measured::of(path);
  return Measured::notAvailable(
      fmt::format("of {:.1f} mm, the tracker's noise may be {:.1f} mm: half or more", 1000.0 * path, 1000.0 * ofNoise));
}

/// Unfiltered it would measure the tracker's noise: 0.2 mm at 100 Hz lengthen it by 42 %.
Measured pathLengthOf(const Motion& motion) { return unlessNoise(pathLength(motion), noisePath(motion)); }

/// Angle of the rotation from a to b, in [0, pi]: 2 atan2(|v|, |w|) of a* b = (w, v), exact for small turns too.
double angleBetween(const Quat& a, const Quat& b) {
  const double w = a.w() * b.w() + a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
  const double x = a.w() * b.x() - a.x() * b.w() - a.y() * b.z() + a.z() * b.y();
  const double y = a.w() * b.y() + a.x() * b.z() - a.y() * b.w() - a.z() * b.x();
  const double z = a.w() * b.z() - a.x() * b.y() + a.y() * b.x() - a.z() * b.w();
  return 2.0 * arctangent2(std::sqrt(x * x + y * y + z * z), std::abs(w));
}

Measured angularPathOf(const Motion& motion) {
  double path = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    if (segment.orientation.empty()) return Measured::notAvailable("the orientation was not recorded");
    for (std::size_t i = 1; i < segment.orientation.size(); ++i)
      path += angleBetween(segment.orientation[i - 1], segment.orientation[i]);
  }
  return Measured::of(path);
}

/// Third column of the rotation matrix of a unit quaternion.
Vec3 axisOf(const Quat& q) {
  return {2.0 * (q.x() * q.z() + q.w() * q.y()), 2.0 * (q.y() * q.z() - q.w() * q.x()),
          1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y())};
}

Measured depthPathOf(const Motion& motion) {
  double path = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    if (segment.orientation.empty()) return Measured::notAvailable("the orientation was not recorded");
    Vec3 before = axisOf(segment.orientation.front());
    for (std::size_t i = 1; i < segment.filtered.size(); ++i) {
      const Vec3 axis = axisOf(segment.orientation[i]);
      const Vec3 step = segment.filtered[i] - segment.filtered[i - 1];
      const double along =
          step.x() * (before.x() + axis.x()) + step.y() * (before.y() + axis.y()) + step.z() * (before.z() + axis.z());
      path += std::abs(along) / 2.0;
      before = axis;
    }
  }
  return unlessNoise(path, 0.5 * noisePath(motion));  // of one component: sqrt(2 / pi) deviations
}

/// 95 % quantile of the chi-squared distribution with 3 degrees of freedom.
constexpr double chiSquared = 7.814727903251179;

Measured workingVolumeOf(const Motion& motion) {
  // A piece of a phase may be a single point, which has no covariance.
  if (motion.points() < 2) return Measured::notAvailable("fewer than two points of motion");
  const auto n = static_cast<double>(motion.points());
  Vec3 mean = Vec3::Zero();
  for (const MotionSegment& segment : motion.segments) {
    for (const Vec3& p : segment.filtered) mean += p;
  }
  mean /= n;
  std::array<double, 6> s{};  // xx yy zz xy xz yz
  for (const MotionSegment& segment : motion.segments) {
    for (const Vec3& p : segment.filtered) {
      const double x = p.x() - mean.x(), y = p.y() - mean.y(), z = p.z() - mean.z();
      s[0] += x * x;
      s[1] += y * y;
      s[2] += z * z;
      s[3] += x * y;
      s[4] += x * z;
      s[5] += y * z;
    }
  }
  for (double& value : s) value /= n - 1.0;
  const double determinant =
      s[0] * (s[1] * s[2] - s[5] * s[5]) - s[3] * (s[3] * s[2] - s[5] * s[4]) + s[4] * (s[3] * s[5] - s[1] * s[4]);
  // Motion in a plane or on a line fills none; rounding may make its determinant negative.
  return Measured::of(4.0 / 3.0 * std::numbers::pi * chiSquared * std::sqrt(chiSquared) *
                      std::sqrt(notNegative(determinant)));
}

Measured meanSpeed(const Motion& motion) {
  const std::vector<double> speeds = speedsOf(motion.segments);
  return Measured::of(std::accumulate(speeds.begin(), speeds.end(), 0.0) / static_cast<double>(speeds.size()));
}

Measured speedPercentile(const Motion& motion) {
  std::vector<double> speeds = speedsOf(motion.segments);
  std::sort(speeds.begin(), speeds.end());
  return Measured::of(quantileOfSorted(speeds, 0.95));
}

Measured count(const Motion& motion) {
  if (std::string why = filledByNoise(motion, motion.movementSpeed); !why.empty())
    return Measured::notAvailable(std::move(why));
  std::size_t movements = 0;
  for (const MotionSegment& segment : motion.segments) movements += movementsOf(segment, motion.movementSpeed).size();
  return Measured::of(static_cast<double>(movements), thresholdNote(motion));
}

/// The chord as a share of the path, not the path over the chord: a movement that returns to its start has a chord of
/// 0.
Measured straightness(const Motion& motion) {
  if (std::string why = filledByNoise(motion, motion.movementSpeed); !why.empty())
    return Measured::notAvailable(std::move(why));
  double chord = 0.0, path = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    for (const Stretch& movement : movementsOf(segment, motion.movementSpeed)) {
      chord += lengthOf(segment.filtered[movement.end - 1] - segment.filtered[movement.begin]);
      path += pathLength(segment, movement.begin, movement.end);
    }
  }
  if (!(path > 0.0)) return Measured::notApplicable(noMovement(motion));
  return Measured::of(chord / path);
}

double idleSeconds(const std::vector<bool>& idle) {
  std::size_t points = 0;
  for (const Stretch& stretch : stretchesOf(idle, pointsOf(idleTime))) points += stretch.points();
  return static_cast<double>(points) / motionRate;
}

Measured idle(const Motion& motion) {
  if (std::string why = filledByNoise(motion, idleSpeed); !why.empty()) return Measured::notAvailable(std::move(why));
  double seconds = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    std::vector<bool> slow(segment.speed.size());
    for (std::size_t i = 0; i < slow.size(); ++i) slow[i] = segment.speed[i] < idleSpeed;
    seconds += idleSeconds(slow);
  }
  return Measured::of(seconds);
}

Measured idleOfBoth(const Motion& left, const Motion& right, const AttemptContext& /*context*/) {
  for (const Motion* hand : {&left, &right}) {
    if (std::string why = filledByNoise(*hand, idleSpeed); !why.empty()) return Measured::notAvailable(std::move(why));
  }
  double seconds = 0.0;
  for (const CommonPart& part : commonParts(left, right, 0)) {
    std::vector<bool> slow(part.points);
    for (std::size_t i = 0; i < slow.size(); ++i) slow[i] = part.left[i] < idleSpeed && part.right[i] < idleSpeed;
    seconds += idleSeconds(slow);
  }
  return Measured::of(seconds);
}

Measured handRatioOf(const Motion& left, const Motion& right, const AttemptContext& context) {
  const double l = pathLength(left), r = pathLength(right);
  if (!(l + r >= minPath)) return Measured::notApplicable("neither hand moved: both paths together are below 1 mm");
  if (!(l + r >= 2.0 * (noisePath(left) + noisePath(right))))
    return Measured::notAvailable("half of both paths or more is the tracker's noise");
  return Measured::of(r / (l + r), fmt::format("handedness {}", context.handedness));
}

Measured correlation(const Motion& left, const Motion& right, const AttemptContext& /*context*/) {
  const std::optional<double> c = speedCorrelation(left, right);
  return c ? Measured::of(*c) : Measured::notApplicable(tooStill);
}

Measured lag(const Motion& left, const Motion& right, const AttemptContext& /*context*/) {
  const std::optional<LaggedCorrelation> best = greatestSpeedCorrelation(left, right, farthestLag);
  if (!best) return Measured::notApplicable(tooStill);
  // The least bad of what doesn't go together is no lag.
  if (!(best->correlation > 0.0))
    return Measured::notApplicable("the hands' speeds do not go together at any lag within 1 s");
  if (std::abs(best->lag) == farthestLag)
    return Measured::notApplicable("the correlation is greatest at the edge of the search, 1 s");
  return Measured::of(static_cast<double>(best->lag) / motionRate,
                      fmt::format("correlation {:.3f}", best->correlation));
}

Measured motionRateOf(const Motion& motion) {
  if (motion.rate == 0.0) return Measured::notApplicable("the pose never changed");
  return Measured::of(motion.rate);
}

}  // namespace

std::vector<CheckpointEntry> motionRows() {
  std::vector<CheckpointEntry> rows;
  const auto addHand = [&](CheckpointEntry row, MotionMeasure measure, int rankInPhases = 0) {
    row = perHand(std::move(row), measure);
    if (rankInPhases > 0) rows.push_back(perHandAndPhase(row, rankInPhases, measure));
    rows.push_back(std::move(row));
  };
  const auto addBoth = [&](CheckpointEntry row, TwoHandMeasure measure) {
    rows.push_back(ofBothHands(std::move(row), measure));
  };
  addHand({.place = {CheckpointFamily::paper, 20, "path"},
           .definition = {.name = "path-length",
                          .title = "Path length of the instrument's tip",
                          .displayUnit = "mm",
                          .direction = Direction::lower,
                          .version = 4,
                          .definition = "L = sum |p(k+1) - p(k)| over the filtered points of the real tip p_WI, "
                                        "within segments",
                          .paperReading = "Total trajectory dist. (left), (right) (mm): path of the real tip in "
                                          "the world, not of the device's handle nor of the simulated tip"}},
          pathLengthOf, 20);
  addHand({.place = {CheckpointFamily::motion, 20},
           .definition = {.name = "depth-path",
                          .title = "Path along the instrument's axis",
                          .displayUnit = "mm",
                          .direction = Direction::lower,
                          .version = 3,
                          .definition = "sum |(p(k+1) - p(k)) . (z(k) + z(k+1)) / 2|, p the filtered tip, z the "
                                        "instrument's axis towards the tip (third column of the filtered "
                                        "orientation), within segments"}},
          depthPathOf, 30);
  addHand({.place = {CheckpointFamily::motion, 30},
           .definition = {.name = "angular-path",
                          .title = "Angular path of the instrument",
                          .displayUnit = "deg",
                          .direction = Direction::lower,
                          .version = 3,
                          .definition = "sum angle(R(k)^T R(k+1)) over the filtered orientations (quaternion "
                                        "components filtered like coordinates, then normalised), within "
                                        "segments"}},
          angularPathOf, 40);
  addHand({.place = {CheckpointFamily::motion, 40},
           .definition = {.name = "speed-mean",
                          .title = "Mean speed of the instrument's tip",
                          .displayUnit = "mm/s",
                          .version = 3,
                          .definition = "mean of v(k) over all points; v(k) = |p(k+1) - p(k-1)| * 50 Hz of the "
                                        "filtered tip, one-sided at the ends of a segment"}},
          meanSpeed, 50);
  addHand({.place = {CheckpointFamily::motion, 50},
           .definition = {.name = "speed-p95",
                          .title = "95th percentile of the tip's speed",
                          .displayUnit = "mm/s",
                          .version = 3,
                          .definition = "quantile of type 7 at 0.95 of v(k) over all points, v as in speed-mean"}},
          speedPercentile);
  addHand({.place = {CheckpointFamily::motion, 60},
           .definition = {.name = "movements",
                          .title = "Number of movements",
                          .direction = Direction::lower,
                          .domain = Domain::whole,
                          .version = 3,
                          .definition = "#{maximal stretches of points with v(k) >= max(v_95 / 2, 5 mm/s) that "
                                        "last 0.2 s or longer}, v as in speed-mean, v_95 the hand's speed-p95 over "
                                        "the attempt, a point lasting 10 ms"}},
          count, 60);
  addHand({.place = {CheckpointFamily::motion, 70},
           .definition = {.name = "movement-straightness",
                          .title = "Straightness of the movements",
                          .direction = Direction::higher,
                          .version = 3,
                          .definition = "sum over movements of |p(last) - p(first)| / sum over movements of their "
                                        "path length; movements as in movements"}},
          straightness);
  addHand({.place = {CheckpointFamily::motion, 80},
           .definition = {.name = "idle-time",
                          .title = "Time at rest",
                          .unit = "s",
                          .direction = Direction::lower,
                          .version = 3,
                          .definition = "sum of the lengths of the maximal stretches of points with v(k) < 5 mm/s "
                                        "that last 0.5 s or longer, v as in speed-mean, a point lasting 10 ms"}},
          idle, 70);
  addHand({.place = {CheckpointFamily::motion, 160},
           .definition = {.name = "working-volume",
                          .title = "Working volume of the instrument's tip",
                          .displayUnit = "ml",
                          .direction = Direction::lower,
                          .version = 3,
                          .definition = "4/3 pi (7.814727903)^(3/2) sqrt(det S): the ellipsoid of normally "
                                        "distributed points that holds 95 % of them; S the covariance (divisor n - "
                                        "1) of all filtered points"}},
          workingVolumeOf, 100);
  addHand({.place = {CheckpointFamily::motion, 170},
           .definition = {.name = "motion-rate",
                          .title = "Effective rate of the tracker",
                          .unit = "Hz",
                          .filter = "none",
                          .version = 3,
                          .definition =
                              "intervals between samples by the time that they fill, those over 1.5 of "
                              "the tracker's own intervals left out (in a file without repeated rows: over 2.5); a "
                              "sample is a measured tick, or a row of the file, whose pose differs from "
                              "the one before",
                          .notOutcome = "it describes the tracker"}},
          motionRateOf);
  rows.back().definition.minCoverage = 0.0;
  rows.back().definition.finality = Finality::running;
  addBoth({.place = {CheckpointFamily::motion, 90},
           .definition = {.name = "idle-time-both",
                          .title = "Time at rest of both hands at once",
                          .unit = "s",
                          .direction = Direction::lower,
                          .instruments = "both hands at the same time",
                          .version = 3,
                          .definition = "as idle-time, of the points at which both hands are measured and v(k) "
                                        "< 5 mm/s for both"}},
          idleOfBoth);
  addBoth({.place = {CheckpointFamily::motion, 130},
           .definition = {.name = "bimanual-correlation",
                          .title = "Correlation of both hands' speeds",
                          .domain = Domain::any,
                          .version = 3,
                          .definition = "Pearson's correlation of v_left(k) and v_right(k), v as in "
                                        "speed-mean, over the points at which both hands are measured"}},
          correlation);
  addBoth({.place = {CheckpointFamily::motion, 140},
           .definition = {.name = "bimanual-lag",
                          .title = "Lag of the right hand behind the left",
                          .unit = "s",
                          .domain = Domain::any,
                          .version = 3,
                          .definition = "the l within 1 s either way for which the correlation of v_left(t) "
                                        "and v_right(t + l) is greatest, if above 0 and not at the edge; "
                                        "positive: the right hand follows"}},
          lag);
  addBoth({.place = {CheckpointFamily::motion, 150},
           .definition = {.name = "hand-ratio",
                          .title = "Right hand's share of both paths",
                          .displayUnit = "%",
                          .window = "whole attempt, while an instrument is mounted and measured",
                          .version = 3,
                          .definition = "L_right / (L_left + L_right), L as in path-length; the value's note "
                                        "gives the handedness"}},
          handRatioOf);
  return rows;
}

}  // namespace calot::analytics
