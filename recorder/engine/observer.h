// SPDX-License-Identifier: GPL-3.0-or-later
// Observers of the loop: the recording's writer, the divergence check, checkpoints, a view. Live, scripted and replayed
// runs feed the same observers.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sim/scene/description.h"
#include "sim/scene/digests.h"
#include "sim/scene/samples.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/step_result.h"

namespace calot::recorder {

/// Result of a haptic tick for one hand.
struct HandTick {
  Vec3 force = Vec3::Zero();     ///< f_W on the operator's hand (N)
  Vec3 torque = Vec3::Zero();    ///< about the instrument's tip, in W (N m)
  std::int64_t contactSet = -1;  ///< step whose contact set the tick used; -1 before the first
};

/// Bit for bit.
inline bool sameForces(const HandTick& a, const HandTick& b) {
  constexpr std::size_t bytes = 3 * sizeof(double);
  return std::memcmp(a.force.data(), b.force.data(), bytes) == 0 &&
         std::memcmp(a.torque.data(), b.torque.data(), bytes) == 0;
}

/// A tick is over when the next one is due (s): one that is later missed its deadline.
inline constexpr float tickDeadline = 0.001F;
/// How far a run at real time may lag behind the tick clock (s). What exceeds it stretches the clock.
inline constexpr float maxLag = 0.1F;

/// One tick: both hands, and how late it ran.
struct TickOutcome {
  std::array<HandTick, handCount> hand;
  /// From when the tick was due until its force was ready (s); 0 when the run is not paced. Above tickDeadline the
  /// deadline was missed. Above maxLag the tick clock was stretched before this tick, by what exceeds it: an event
  /// of the step (EventKind::clockStretched).
  float lateness = 0.0F;
};

/// Redundancy in a part of a keyframe, which need not be stored (schemas/recording.md). Numbers
/// are stored and never reused.
enum class PartForm : std::uint64_t {
  plain = 0,
  quaternions = 1,        ///< a list of unit quaternions, x y z w: w
  quaternionsByLane = 2,  ///< groups of eight unit quaternions, eight w, eight x and so on: w
  symmetricMatrix = 3,    ///< row after row: what lies below the diagonal
  unchanged = 4,          ///< all of it, from the keyframe before; made by the writer alone
};

struct KeyframePart {
  std::uint32_t bytes = 0;
  PartForm form = PartForm::plain;
};

/// Full state after a step, as bytes: enough to go on from the next step.
struct Keyframe {
  std::uint64_t step = 0;
  std::vector<std::byte> state;    ///< State, by its field list
  std::vector<std::byte> haptics;  ///< HapticState of each hand, and every contact set that later ticks still name
  /// The fields of state, then of haptics: where the like of them lies in another keyframe. Empty where it was read.
  std::vector<KeyframePart> parts = {};
};

/// One step of the loop. References live for the call only.
struct StepRecord {
  std::uint64_t step = 0;
  std::span<const TickSamples> samples;  ///< ticksPerStep of them
  std::span<const TickOutcome> ticks;    ///< as many
  const StepResult& result;
  const StateDigest& digest;  ///< empty where a recorded step of format version 2 stands for a computed one
  float lateness = 0.0F;      ///< how long after the step was due it began (s); 0 when not paced
  /// Makes the keyframe of this step; costs a copy of the State, so it is called only where one is kept. Empty where a
  /// recorded step stands for a computed one (ReplaySettings::observers) and where another program computes steps ahead
  /// of time, as is `view`.
  std::function<Keyframe()> keyframe;
  /// Makes the scene view of this step; costs surfaces, so it is called only by what draws.
  std::function<SceneView()> view;
};

/// How an attempt ended. Numbers are stored and never reused.
enum class Outcome : std::uint8_t {
  running = 0,
  completed = 1,
  timeLimit = 2,
  abandoned = 3,
  stopped = 4,
  technicalFailure = 5
};

/// Names, as recordings store them, and as tables and reports have them. @pre the value is one that has a name
inline constexpr std::array<const char*, 6> outcomeNames{"running",   "completed", "time_limit",
                                                         "abandoned", "stopped",   "technical_failure"};
inline constexpr const char* wordFor(Outcome outcome) {
  if (outcome == Outcome::timeLimit) return "time limit";
  if (outcome == Outcome::technicalFailure) return "technical failure";
  return outcomeNames[static_cast<std::size_t>(outcome)];
}

/// Called with steps done, of all.
using StepProgress = std::function<void(std::uint64_t step, std::uint64_t of)>;

class Observer {
 public:
  virtual ~Observer() = default;
  virtual void onStep(const StepRecord& record) = 0;
  virtual void onEnd(Outcome outcome) = 0;
};

}  // namespace calot::recorder
