// SPDX-License-Identifier: GPL-3.0-or-later
// Steps and haptic ticks together, as a live run has them: each tick feels the contact set of the step before.
#pragma once

#include <array>
#include <vector>

#include "sim/haptics/haptic_tick.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot::test {

class Loop {
 public:
  explicit Loop(const Model& model) : model_(model), rig(model) {
    for (std::size_t h = 0; h < handCount; ++h) haptic[h] = initialHaptics(rig.state, h);
  }

  /// A sample of both hands at home, to be changed.
  [[nodiscard]] TickSamples resting() const {
    TickSamples tick;
    for (std::size_t h = 0; h < handCount; ++h) {
      tick.hand[h].position = model_.scene().hands[h].home;
      tick.hand[h].instrument = model_.scene().hands[h].instrument;
    }
    tick.camera = model_.scene().camera;
    return tick;
  }

  /// One step. @param sample (time in s) -> TickSamples @param felt () is called after each tick; `force` and `haptic`
  /// hold what it made
  template <class Sample, class Felt>
  const StepResult& step(Sample&& sample, Felt&& felt) {
    std::vector<TickSamples> ticks;
    for (std::uint32_t k = 0; k < model_.scene().ticksPerStep; ++k) {
      ticks.push_back(sample(0.001 * static_cast<double>(tick_++)));
      for (std::size_t h = 0; h < handCount; ++h) {
        takeSample(model_, h, ticks.back().hand[h], haptic[h]);
        force[h] = hapticTick(hapticModel(model_, h), haptic[h], rig.stepper.contactSet(h));
      }
      felt();
    }
    return rig.stepper.step(rig.state, ticks);
  }

 private:
  const Model& model_;
  std::uint64_t tick_ = 0;

 public:
  Rig rig;
  std::array<HapticState, handCount> haptic;
  std::array<HapticForce, handCount> force;
};

/// What one hand feels over a run: the largest change between ticks, the largest force, and the work that the device
/// did on the operator. A force is held from its tick to the next.
struct Felt {
  double maxJump = 0.0;    ///< N
  double maxForce = 0.0;   ///< N
  double work = 0.0;       ///< of the device on the operator (J); a passive device's is not positive on closed paths
  double exchanged = 0.0;  ///< sum of the absolute parts (J)
  bool first = true;
  Vec3 lastForce = Vec3::Zero();
  Vec3 lastTip = Vec3::Zero();

  void take(const HapticState& state, const HapticForce& force) {
    if (!first) {
      maxJump = std::max(maxJump, (force.force - lastForce).norm());
      const double part = lastForce.dot(state.tip - lastTip);
      work += part;
      exchanged += std::abs(part);
    }
    first = false;
    maxForce = std::max(maxForce, force.force.norm());
    lastForce = force.force;
    lastTip = state.tip;
  }
};

}  // namespace calot::test
