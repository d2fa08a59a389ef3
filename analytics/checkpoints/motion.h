// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analytics/checkpoints/sample_grid.h"
#include "analytics/checkpoints/sample_rate.h"
#include "analytics/checkpoints/time_spans.h"
#include "sim/math/linear.h"

namespace calot::analytics {

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

/// One hand's motion over an attempt, or over a part of it.
struct Motion {
  bool mounted = false;                 ///< there was an instrument at any time
  MotionCoverage coverage;              ///< when there was, and when nothing was measured of it
  double interval = 0.0;                ///< the tracker's own (s), as SampleRate::interval()
  double rate = 0.0;                    ///< of the samples by the clock, gaps left out (Hz); 0: too few to tell
  double cutoff = motionCutoff;         ///< of the filter (Hz)
  double movementSpeed = 0.0;           ///< threshold of this hand's movements (m/s), as movementSpeedOf()
  std::vector<MotionSegment> segments;  ///< each long enough for the filter

  [[nodiscard]] std::uint64_t points() const;  ///< of all segments
};

/// What a hand's samples were before they are resampled at once.
struct MotionSamples {
  SampleGrid grid;           ///< samples up to 0.1 s apart joined; those farther apart begin a run
  SampleRate rate;           ///< intervals
  double longestRate = 0.0;  ///< intervals counted in the rate (s)
  MotionCoverage coverage;
  bool oriented = true;  ///< false: orientations are not known, and left out
};

/// Bridges gaps (gap_bridge.h), filters, takes the speeds. Runs too short for the filter are left out; beside a gap
/// they count as lost with it.
Motion filteredMotion(MotionSamples samples, double cutoff);

}  // namespace calot::analytics
