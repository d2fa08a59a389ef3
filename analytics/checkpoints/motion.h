// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analytics/checkpoints/sample_grid.h"
#include "analytics/checkpoints/sample_rate.h"
#include "sim/math/linear.h"
#include "sim/scene/samples.h"

namespace calot::analytics {

/// Default cut-off of the motion filter (Hz), and those that may be asked for. Stored values are of the default.
inline constexpr double motionCutoff = 6.0;
inline constexpr double motionCutoffs[] = {3.0, 6.0, 10.0};
/// A longer time without measurement (s) is not bridged: the motion falls into two segments. A pose that stands for
/// longer while the source vouches for it is rest.
inline constexpr double maxBridge = 0.1;
/// Effective rate (Hz) below which third derivatives of a motion are not given. Half a hertz of tolerance: trackers of
/// "30 Hz" deliver 29.97 and lose samples.
inline constexpr double minJerkRate = 29.5;

/// Text of resampling and filter, stored with every value that uses them.
std::string motionFilterText(double cutoff = motionCutoff);

/// Uninterrupted motion of one instrument's tip, 1 / motionRate apart. All arrays have the same length.
struct MotionSegment {
  std::int64_t first = 0;         ///< index of the first point on the grid t = k / motionRate
  std::vector<Vec3> raw;          ///< resampled p_WI (m)
  std::vector<Vec3> filtered;     ///< zero phase
  std::vector<Quat> orientation;  ///< q_WI, components filtered alike and normalised; empty where it is not known
  std::vector<double> speed;      ///< |(p(k+1) - p(k-1)) rate / 2| of the filtered points (m/s); one-sided at both ends
};

/// One hand's motion over an attempt, or over a part of it.
struct Motion {
  bool mounted = false;  ///< there was an instrument at any time
  std::uint64_t mountedTicks = 0;
  std::uint64_t validTicks = 0;         ///< mounted and measured
  double unmeasured = 0.0;              ///< time with an instrument that no segment covers (s)
  double rate = 0.0;                    ///< effective rate of the samples (Hz); 0: too few to tell
  double cutoff = motionCutoff;         ///< of the filter (Hz)
  std::vector<MotionSegment> segments;  ///< each long enough for the filter

  [[nodiscard]] std::uint64_t points() const;  ///< of all segments
};

/// Filters the runs of a grid and takes the speeds. Runs too short for the filter are left out.
/// @param oriented false: orientations are not known, and left out.
std::vector<MotionSegment> filteredSegments(std::vector<GridRun> runs, double cutoff, bool oriented = true);

/// Collects one hand's ticks and finds the tracker's own samples among them. A source holds its newest sample until
/// there is another one, so:
///
/// - a valid tick whose pose (position or orientation, to the last bit) differs from the one before is a sample;
/// - a pose that stands for at most 0.1 s was held, and the motion runs straight to the next sample;
/// - a valid pose that stands for longer is rest, because sources mark what they hold longer as not measured: it lasts
///   until one sampling interval (the newest known) before the next sample, and is a point again there;
/// - ticks that the source marked as not measured are nothing; 0.1 s of them are bridged, more split the motion, as an
///   exchange of the instrument does.
///
/// Where the source itself interpolated (kinematics files, docs/sources.md), only the first tick of each interval
/// of the file's rows can be a sample. Deterministic contract.
class MotionTrack {
 public:
  /// @param tickSeconds length of a tick (s). @pre > 0.
  /// @param sourceRate of a source that interpolates between its samples (Hz); 0: it doesn't.
  explicit MotionTrack(double tickSeconds, double sourceRate = 0.0);

  void add(const InstrumentSample& sample);

  /// The motion so far, filtered. Cost: one pass over the points.
  [[nodiscard]] Motion motion(double cutoff = motionCutoff) const;

 private:
  void begin(const InstrumentSample& sample);
  void sampled(const InstrumentSample& sample);
  void closeRest(SampleGrid& grid) const;
  [[nodiscard]] bool isDue() const;
  [[nodiscard]] double seconds(std::int64_t ticks) const { return static_cast<double>(ticks) * tickSeconds_; }

  double tickSeconds_;
  double rowsPerTick_;
  SampleGrid grid_;
  SampleRate rate_;
  std::int64_t tick_ = -1;
  std::int64_t sample_ = -1;   ///< tick of the newest sample
  std::int64_t vouched_ = -1;  ///< newest valid tick with its pose
  std::int64_t interval_ = 1;  ///< ticks between the two newest samples that weren't rest apart
  Vec3 position_ = Vec3::Zero();
  Quat orientation_ = Quat::Identity();  ///< as recorded
  InstrumentKind instrument_ = InstrumentKind::none;
  std::uint64_t mountedTicks_ = 0, validTicks_ = 0;
};

}  // namespace calot::analytics
