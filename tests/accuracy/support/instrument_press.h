// SPDX-License-Identifier: GPL-3.0-or-later
// The left instrument, upright, pressed into what lies below its place, through the whole step.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "sim/step/stepper.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot::test {

class InstrumentPress {
 public:
  /// @param scene without friction, if forces are compared with a solution that has none
  /// @param top height of the surface below (m)
  InstrumentPress(SceneDescription scene, InstrumentKind instrument, double x, double y, double top)
      : instrument_(instrument), x_(x), y_(y), top_(top), scene_(std::move(scene)) {
    HandDescription& hand = scene_.hands[0];
    hand.instrument = instrument;
    hand.port = Vec3(x, y, 0.13);
    hand.couplingStiffness = 1e4;
    hand.maxForce = 1e3;
    model_ = buildModel(scene_);
    state_ = initialState(*model_, 1);
    stepper_ = std::make_unique<Stepper>(*model_, executor_);
  }

  [[nodiscard]] double seconds() const { return model_->stepSeconds(); }

  /// One step with the tip so far below the top (m).
  const StepResult& step(double depth) {
    std::vector<TickSamples> samples = ticksAt(scene_, Vec3(x_, y_, top_ - depth), scene_.hands[1].home);
    for (TickSamples& tick : samples) tick.hand[0].instrument = instrument_;
    const StepResult& result = stepper_->step(state_, samples);
    misses += result.misses != 0 ? 1 : 0;
    return result;
  }

  /// Goes there at 25 mm/s and waits until all is slower than `still` (m/s), or for a second.
  void settle(double depth, double still) {
    const StepResult* result = nullptr;
    double waited = 0.0;
    for (double now = depth_; waited < 1.0;) {
      now = std::min(depth, now + 0.025 * seconds());
      result = &step(now);
      if (now < depth) continue;
      waited += seconds();
      double fastest = 0.0;
      for (const OrganResult& organ : result->organ) fastest = std::max(fastest, organ.maxSpeed);
      for (const FatResult& fat : result->fat) fastest = std::max(fastest, fat.maxSpeed);
      if (fastest < still) break;
    }
    depth_ = depth;
    tip = top_ - result->hand[0].tipSimulated[2];
    force = result->hand[0].contactForce[2];
  }

  double tip = 0.0;    ///< depth of the simulated one (m)
  double force = 0.0;  ///< N
  int misses = 0;

 private:
  InstrumentKind instrument_;
  double x_, y_, top_;
  double depth_ = -0.002;
  SceneDescription scene_;
  std::unique_ptr<const Model> model_;
  SerialExecutor executor_;
  State state_;
  std::unique_ptr<Stepper> stepper_;
};

}  // namespace calot::test
