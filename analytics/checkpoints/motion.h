// SPDX-License-Identifier: GPL-3.0-or-later
// The motion of one instrument: samples, gaps and bridges, resampling to a fixed rate, zero-phase filter, segments.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analytics/checkpoints/tracker_noise.h"
#include "sim/math/linear.h"

namespace calot::analytics {

/// Length of a vector, in source-fixed order.
inline double lengthOf(const Vec3& v) { return std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()); }

/// Rate of the motion on which motion checkpoints work (Hz).
inline constexpr double motionRate = 100.0;

/// A pose at its time.
struct TimedPose {
  double time = 0.0;  ///< in the unit of the grid's times
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();  ///< unit
};

/// Poses at the points k / motionRate of one uninterrupted motion.
struct GridRun {
  std::int64_t first = 0;         ///< k of the first point
  std::vector<Vec3> position;     ///< p_WI (m)
  std::vector<Quat> orientation;  ///< q_WI, unit, each on the side of its predecessor; as many
  TimedPose begin, end;           ///< first and last sample
  bool continues = false;         ///< it goes on from the run before, after a time without samples

  /// Appends a pose at the next point. @param orientation unit, of either sign
  void append(const Vec3& p, const Quat& orientation);
};

/// Time of point k, in a unit given by its number per second; correctly rounded where that is a whole
/// number.
double gridTime(std::int64_t k, double unitsPerSecond);

/// Resamples the poses of a tracker to the grid t = k / motionRate: positions on the straight line between the samples
/// around a point, orientations (normalised) by normalised linear interpolation on the shorter arc; on a sample (within
/// a millionth of a grid interval): that sample. Nothing is extrapolated. Deterministic contract.
class SampleGrid {
 public:
  /// @param unitsPerSecond of the times that are given: 1000 for ticks, 30 for rows at 30 Hz, 1 for seconds. @pre > 0.
  explicit SampleGrid(double unitsPerSecond) : unitsPerSecond_(unitsPerSecond) {}

  /// A sample that begins a new run. @param continues GridRun::continues. @pre later than every sample before.
  void begin(double time, const Vec3& position, const Quat& orientation, bool continues = false);
  /// A sample that goes on from the one before it. @pre as begin(), and there was one.
  void extend(double time, const Vec3& position, const Quat& orientation);

  [[nodiscard]] const std::vector<GridRun>& runs() const { return runs_; }
  [[nodiscard]] std::vector<GridRun> takeRuns() && { return std::move(runs_); }
  [[nodiscard]] double unitsPerSecond() const { return unitsPerSecond_; }
  [[nodiscard]] const TrackerNoise& noise() const { return noise_; }

 private:
  void put(const Vec3& position, const Quat& orientation);

  double unitsPerSecond_;
  std::int64_t next_ = 0;
  std::vector<GridRun> runs_;
  TrackerNoise noise_;
};

/// A tracker's own interval and its rate by the clock, from the times between its samples. Times over `longestInterval`
/// are pauses and count for neither. Deterministic contract.
class SampleRate {
 public:
  static constexpr double longestInterval = 1.0;  ///< s

  /// @param seconds since the sample before, > 0.
  void add(double seconds);

  /// The tracker's own interval (s): the median. Where intervals up to 1.5 medians fill less than a tenth of the time,
  /// samples arrive in bursts, and it is the interval up to which intervals fill half of the time. 0: none was added.
  [[nodiscard]] double interval() const;

  /// Intervals of at most `longest` (s) by the time that they fill (Hz); 0: there is none.
  [[nodiscard]] double hertz(double longest) const;

 private:
  /// Intervals by their length, to 10 us.
  struct Bin {
    std::uint64_t count = 0;
    double seconds = 0.0;
  };
  /// Merges intervals of at most this length (s).
  [[nodiscard]] Bin upTo(double longest) const;

  std::vector<Bin> bins_;
  Bin all_;
};

/// Times [begin, end) (s).
struct TimeSpan {
  double begin = 0.0, end = 0.0;
};

/// Spans in order, none empty, none overlapping.
using TimeSpans = std::vector<TimeSpan>;

/// Sorted; those that overlap or touch are joined, empty ones dropped.
TimeSpans normalized(TimeSpans spans);
TimeSpans intersection(const TimeSpans& a, const TimeSpans& b);
TimeSpans unionOf(const TimeSpans& a, const TimeSpans& b);
/// Seconds that all spans last.
double lengthOf(const TimeSpans& spans);

/// Coverage of a hand's work by a tracker's samples.
struct MotionCoverage {
  TimeSpans mounted;  ///< with an instrument
  TimeSpans lost;     ///< of these, without measurement

  /// 1 - |lost| / |mounted|, in [0, 1]. @return nothing where no instrument was mounted.
  [[nodiscard]] std::optional<double> share() const;
};

/// Coverage of a part of the attempt.
MotionCoverage coverageWithin(const MotionCoverage& coverage, const TimeSpans& window);
/// While both hands have an instrument; lost is what either hand lost.
MotionCoverage ofBoth(const MotionCoverage& left, const MotionCoverage& right);

/// Default cut-off of the motion filter (Hz), and those that may be asked for. Stored values are of the default.
inline constexpr double motionCutoff = 6.0;
inline constexpr double motionCutoffs[] = {3.0, 6.0, 10.0};
/// Rate (Hz) of a tracker's own interval below which third derivatives of a motion are not given. Half a hertz of
/// tolerance: trackers of "30 Hz" deliver 29.97.
inline constexpr double minJerkRate = 29.5;

/// Text of resampling, bridging and filter, stored with every value that uses them.
std::string motionFilterText(double cutoff = motionCutoff);

/// Uninterrupted motion of one instrument's tip, 1 / motionRate apart. All arrays have the same length.
struct MotionSegment {
  std::int64_t first = 0;         ///< index of the first point on the grid t = k / motionRate
  std::vector<Vec3> raw;          ///< resampled p_WI (m)
  std::vector<Vec3> filtered;     ///< zero phase
  std::vector<Quat> orientation;  ///< q_WI, components filtered alike and normalised; empty where it is not known
  std::vector<double> speed;      ///< |(p(k+1) - p(k-1)) rate / 2| of the filtered points (m/s); one-sided at both ends
  bool continues = false;         ///< a gap that was too long to be bridged lies before it
};

/// Speeds of all points, in order.
std::vector<double> speedsOf(const std::vector<MotionSegment>& segments);

/// One hand's motion over an attempt, or over a part of it.
struct Motion {
  bool mounted = false;                 ///< there was an instrument at any time
  MotionCoverage coverage;              ///< when there was, and when nothing was measured of it
  double interval = 0.0;                ///< the tracker's own (s), as SampleRate::interval()
  double rate = 0.0;                    ///< of the samples by the clock, gaps left out (Hz); 0: the pose never changed
  std::optional<double> noise = {};     ///< TrackerNoise::deviation() (m); nothing: too few samples
  std::size_t leftOut = 0;              ///< samples that no hand gives (recorder::markInvalidSamples())
  double cutoff = motionCutoff;         ///< of the filter (Hz)
  double movementSpeed = 0.0;           ///< threshold of this hand's movements (m/s), as movementSpeedOf()
  std::vector<MotionSegment> segments;  ///< each long enough for the filter

  [[nodiscard]] std::uint64_t points() const;  ///< of all segments
};

/// A hand's samples before resampling.
struct MotionSamples {
  SampleGrid grid;           ///< samples up to 0.1 s apart joined; those farther apart begin a run
  SampleRate rate;           ///< intervals
  double longestRate = 0.0;  ///< intervals counted in the rate (s)
  MotionCoverage coverage;
  bool oriented = true;  ///< false: orientations are not known, and left out
};

/// Bridges gaps (bridged()), filters, takes the speeds. Runs too short for the filter are left out; beside a gap
/// they count as lost with it.
Motion filteredMotion(MotionSamples samples, double cutoff);

/// Samples this close (s) are joined by a straight line whatever the tracker's interval; sources repeat a pose for as
/// long.
inline constexpr double straightBridge = 0.1;
/// A gap: more than this number of the tracker's own intervals between two samples.
inline constexpr double gapIntervals = 2.5;
/// More lost time (s) is not bridged: the motion falls into two segments.
inline constexpr double maxBridge = 1.0;

/// How a time between two samples is taken, by the tracker's own interval.
struct GapRule {
  double interval;  ///< SampleRate::interval() (s); 0: not known

  /// Longest time between two samples that is no gap (s).
  [[nodiscard]] double longestEven() const { return gapIntervals * interval; }
  [[nodiscard]] bool isGap(double seconds) const { return seconds > longestEven(); }
  /// Part of a gap that no sample covers, each covering one interval.
  [[nodiscard]] double lost(double seconds) const { return seconds - interval; }
  /// Joined by a straight line.
  [[nodiscard]] bool isStraight(double seconds) const { return seconds <= straightBridge || !isGap(seconds); }
  /// Joined, by a straight line or a curve.
  [[nodiscard]] bool isBridged(double seconds) const { return isStraight(seconds) || lost(seconds) <= maxBridge; }
};

/// Joins runs to those that they continue, where the rule bridges the time between them. Straight: as SampleGrid.
/// Curved: positions on the cubic Hermite curve through both samples,
///
///   p(s) = (2 s^3 - 3 s^2 + 1) p_0 + (s^3 - 2 s^2 + s) h v_0 + (3 s^2 - 2 s^3) p_1 + (s^3 - s^2) h v_1,  s = (t - t_0)
///   / h,
///
/// v_0 and v_1 the least-squares slopes of the motion over the 0.1 s (or one of the tracker's intervals, if longer)
/// before and after it, the chord's where fewer than two points are there; orientations by normalised linear
/// interpolation. Deterministic contract.
std::vector<GridRun> bridged(std::vector<GridRun> runs, const GapRule& rule, double unitsPerSecond);

/// Second-order Butterworth low-pass, run forward and backward: no delay, fourth-order roll-off.
///
/// Design: bilinear transform, pre-warped so that one pass has -3 dB exactly at the cut-off; both passes together have
/// -6 dB there (their -3 dB lies at 0.802 of it). The cut-off is not raised by 1/0.802 to make up for that.
/// Edges: the signal is extended at both ends by up to `edge` values (all but one of them where it is shorter),
/// mirrored through its end point (2 x_0 - x_k). Half a second at 100 Hz: the start-up of a 6 Hz filter has died away
/// to 2e-6, where the customary nine values leave a tenth of it. Initial state: that of a constant input equal to the
/// first value of the extended signal, for each pass. These are the conventions of scipy.signal.filtfilt(*butter(2, fc,
/// fs=fs), x, padlen=min(50, len(x) - 1)).
///
/// Own arithmetic (+ - * / sqrt, and sine and cosine of sim/math), in source-fixed order.
class ZeroPhaseFilter {
 public:
  static constexpr std::size_t edge = 50;
  static constexpr std::size_t shortest = 10;  ///< values that a signal must have at least

  /// @param cutoff, rate in Hz. @pre 0 < cutoff < rate / 2.
  ZeroPhaseFilter(double cutoff, double rate);

  /// @pre signal.size() >= shortest. Returns as many values.
  [[nodiscard]] std::vector<double> apply(std::span<const double> signal) const;

 private:
  void pass(std::vector<double>& signal) const;
  double b0_ = 0.0, b1_ = 0.0, b2_ = 0.0, a1_ = 0.0, a2_ = 0.0;
};

}  // namespace calot::analytics
