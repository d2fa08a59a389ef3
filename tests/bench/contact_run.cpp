// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/contact_run.h"

#include <benchmark/benchmark.h>

#include "tests/bench/thread_clock.h"

namespace calot::bench {

DeformationAlone::DeformationAlone(const Model& model, Executor& executor)
    : model_(model), executor_(executor), solver_(model.organs().size()) {
  settings_.step = model.stepSeconds();
  settings_.tolerance = model.scene().solver.tolerance;
  settings_.cap = model.scene().solver.iterations;
}

std::uint32_t DeformationAlone::step(std::vector<SolidState>& organ) {
  std::uint32_t iterations = 0;
  for (std::size_t o = 0; o < organ.size(); ++o) {
    const SolidModel& solid = model_.organs()[o].solid;
    iterations +=
        solver_[o].solveUnconstrained(solid, organ[o], model_.scene().gravity, {}, settings_, executor_).iterations;
    solver_[o].advance(solid, organ[o], {}, settings_.step);
  }
  return iterations;
}

ContactRun::ContactRun(const Model& model) : model_(model), stepper_(model, executor_), peer_(model, executor_) {
  for (std::size_t h = 0; h < handCount; ++h) haptic_[h] = hapticModel(model, h);
}

double ContactRun::prepare() {
  const double start = threadSeconds();
  stepper_.precompute();
  return threadSeconds() - start;
}

std::vector<StepCost> ContactRun::run(const Motion& motion) {
  std::vector<StepCost> costs;
  State state = initialState(model_, 1);
  stepper_.invalidate();
  std::array<HapticState, handCount> haptics;
  for (std::size_t h = 0; h < handCount; ++h) haptics[h] = initialHaptics(state, h);
  std::vector<SolidState> before;
  for (std::size_t n = 0; n < motion.step.size(); ++n) {
    before = state.organ;
    const double start = threadSeconds();
    for (const TickSamples& tick : motion.step[n]) {
      for (std::size_t h = 0; h < handCount; ++h) {
        takeSample(model_, h, tick.hand[h], haptics[h]);
        benchmark::DoNotOptimize(hapticTick(haptic_[h], haptics[h], stepper_.contactSet(h)));
      }
    }
    const double ticked = threadSeconds();
    const StepResult& result = stepper_.step(state, motion.step[n]);
    const double stepped = threadSeconds();
    StepCost cost;
    cost.peerIterations = peer_.step(before);
    cost.deformation = threadSeconds() - stepped;
    if (n < motion.approach) continue;
    cost.ticks = ticked - start;
    cost.whole = stepped - start;
    cost.contact = result.contact;
    cost.bothTouch = result.hand[0].touching != 0 && result.hand[1].touching != 0;
    for (const OrganResult& organ : result.organ) cost.iterations += organ.iterations;
    costs.push_back(cost);
  }
  return costs;
}

}  // namespace calot::bench
