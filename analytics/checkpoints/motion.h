// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "sim/math/linear.h"
#include "sim/scene/samples.h"

namespace calot::analytics {

/// Rate of the motion on which motion checkpoints work (Hz), and cut-off of their filter (Hz).
inline constexpr double motionRate = 100.0;
inline constexpr double motionCutoff = 6.0;
/// A longer time without measurement (s) is not bridged: the motion falls into two segments.
inline constexpr double longestBridge = 0.1;

/// Text of resampling and filter, stored with every value that uses them.
inline constexpr const char* motionFilterText =
    "valid ticks, linear to 100 Hz, gaps over 0.1 s split; Butterworth order 2 at 6 Hz forward and backward, odd "
    "extension by 50, steady initial state, cut-off not corrected by 0.802";

/// Uninterrupted motion of one instrument's tip, 1 / motionRate apart.
struct MotionSegment {
  std::int64_t first = 0;      ///< index of the first point on the grid t = k / motionRate
  std::vector<Vec3> raw;       ///< resampled p_WI (m)
  std::vector<Vec3> filtered;  ///< zero phase; as many
};

/// One hand's motion over an attempt.
struct Motion {
  bool mounted = false;  ///< there was an instrument at any time
  std::uint64_t mountedTicks = 0;
  std::uint64_t validTicks = 0;         ///< mounted and measured
  double unmeasured = 0.0;              ///< time with an instrument that no segment covers (s)
  std::vector<MotionSegment> segments;  ///< each long enough for the filter
};

/// Collects one hand's samples tick by tick and resamples them: points of the grid t = k / motionRate are linear
/// between the valid ticks around them (on a tick: that tick's pose). Ticks that the source marked as not measured are
/// not points; an instrument exchange begins a new segment. Deterministic contract.
class MotionTrack {
 public:
  /// @param tickSeconds length of a tick (s). @pre > 0.
  explicit MotionTrack(double tickSeconds);

  void add(const InstrumentSample& sample);

  /// The motion so far, filtered. Cost: one pass over the points.
  [[nodiscard]] Motion motion() const;

 private:
  void begin(const Vec3& position);
  void extend(const Vec3& position);
  [[nodiscard]] double tickOf(std::int64_t gridIndex) const;

  struct Run {
    std::int64_t first = 0;
    std::vector<Vec3> points;
  };
  double ticksPerPoint_;
  double tickSeconds_;
  std::int64_t tick_ = -1;
  std::int64_t lastValid_ = -1;
  std::int64_t next_ = 0;  ///< grid index of the next point
  Vec3 lastPosition_ = Vec3::Zero();
  InstrumentKind instrument_ = InstrumentKind::none;
  std::uint64_t mountedTicks_ = 0, validTicks_ = 0;
  std::vector<Run> runs_;
};

}  // namespace calot::analytics
