// SPDX-License-Identifier: GPL-3.0-or-later
// A hand of a closed-loop performer: queued strokes become samples as time passes.
#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include "recorder/sources/performer_profile.h"
#include "recorder/sources/unsteadiness.h"
#include "sim/math/random.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// A command for a hand: a straight minimum-jerk stroke, then a pause.
struct HandMove {
  enum class Aim : std::uint8_t {
    none,     ///< the roll stays as it is
    hinge,    ///< the jaws' hinge lies along `aim`, either way round
    forward,  ///< y_I, the direction of a hook's toe, is as close to `aim` as the shaft allows
  };

  Vec3 to = Vec3::Zero();  ///< p_WI where the stroke is meant to end (m)
  double speed = 0.03;     ///< mean (m/s)
  double jaw = 0.0;        ///< at its end (rad)
  Aim aiming = Aim::none;
  Vec3 aim = Vec3::UnitX();                          ///< unit, in W
  std::uint8_t buttons = 0;                          ///< while it lasts
  double dwell = 0.0;                                ///< rest at its end, buttons as they are (s)
  InstrumentKind instrument = InstrumentKind::none;  ///< mounted as the stroke begins; none: the same as before
  bool steady = false;                               ///< at constant speed, as in dissection, instead of minimum jerk
  bool sure = false;                                 ///< without the noise of its length: small corrections, and rests
};

/// Strokes are minimum-jerk (Flash and Hogan 1985) and miss the goal by noise proportional to their length (Harris and
/// Wolpert 1998); some overshoot. Tremor and drift are superposed.
class PerformerHand {
 public:
  PerformerHand(const PerformerProfile& profile, const HandDescription& hand, std::size_t index, std::uint64_t seed);

  void add(const HandMove& move);
  /// Drops commands that have not started.
  void clear();
  [[nodiscard]] std::size_t waiting() const { return queue_.size(); }
  /// Is the hand idle at `time` (s)?
  [[nodiscard]] bool idle(double time) const { return queue_.empty() && time >= end_; }
  /// Ends the current stroke within `seconds` and drops the rest of the queue.
  [[nodiscard]] bool idleIn(double seconds, double time) const { return queue_.empty() && time + seconds >= end_; }
  /// Intended position after all queued commands (m).
  [[nodiscard]] const Vec3& meant() const { return queue_.empty() ? stroke_.to : queue_.back().to; }
  [[nodiscard]] InstrumentKind instrument() const { return instrument_; }
  [[nodiscard]] const HandDescription& description() const { return hand_; }
  /// Along the shaft into the body, with the tip at p.
  [[nodiscard]] Vec3 shaft(const Vec3& p) const;

  /// @pre called with times that do not fall
  InstrumentSample sample(double time);

 private:
  struct Running {
    double start = 0.0, duration = 0.0;
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
    double jawFrom = 0.0, jawTo = 0.0, rollFrom = 0.0, rollTo = 0.0;
    std::uint8_t buttons = 0;
    bool steady = false;
  };
  void begin(double time);
  [[nodiscard]] double progress(double time) const;
  [[nodiscard]] double rollFor(const HandMove& move) const;

  const PerformerProfile& profile_;
  HandDescription hand_;
  Random random_;
  Unsteadiness tremor_, wander_;
  std::deque<HandMove> queue_;
  Running stroke_;
  double end_ = 0.0;  ///< of the stroke that runs and its rest (s)
  InstrumentKind instrument_ = InstrumentKind::none;
};

}  // namespace calot::recorder
