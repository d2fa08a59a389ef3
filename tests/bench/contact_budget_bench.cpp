// SPDX-License-Identifier: GPL-3.0-or-later
// Time against error of the contact response over its budgets: the same steps from the same States, once with each
// budget and once converged.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/step/stepper.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/contact_run.h"
#include "tests/bench/numbers.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench {

namespace {

constexpr std::size_t steps = 200;
constexpr std::size_t every = 5;     // so many steps lie between two that are looked at
constexpr double leastForce = 0.05;  // errors of smaller forces are told relative to this (N)

/// Where the budgets are tried: States before chosen steps of the motion, and the converged forces after them.
struct Probe {
  std::size_t step;
  State before;
  std::array<Vec3, handCount> force;
};

SceneDescription converged(SceneDescription scene) {
  scene.solver.tolerance = 1e-7;
  scene.solver.speedTolerance = scene.solver.responseSpeedTolerance = 0.0;
  scene.solver.iterations = 2000;
  scene.solver.responseTolerance = 1e-6;
  scene.solver.contactTolerance = 1e-11;
  scene.solver.contactIterations = 1000;
  scene.solver.contactPasses = 100;
  return scene;
}

struct Probes {
  Motion motion;
  std::vector<Probe> probe;
};

const Probes& probes() {
  static const Probes all = [] {
    Probes made;
    const std::unique_ptr<const Model> model = built(touchLiver());
    const std::unique_ptr<const Model> exact = built(converged(touchLiver()));
    made.motion = pressAndSlide(model->scene(), steps);
    SerialExecutor executor;
    Stepper stepper(*model, executor);
    Stepper exactStepper(*exact, executor);
    State state = initialState(*model, 1);
    for (std::size_t n = 0; n < made.motion.step.size(); ++n) {
      if (n >= made.motion.approach && n % every == 0) {
        State copy = state;
        exactStepper.invalidate();
        const StepResult& result = exactStepper.step(copy, made.motion.step[n]);
        made.probe.push_back({n, state, {result.hand[0].contactForce, result.hand[1].contactForce}});
      }
      stepper.step(state, made.motion.step[n]);
    }
    return made;
  }();
  return all;
}

/// @param passes, sweeps the budget that is tried
void budget(benchmark::State& bench, std::uint32_t passes, std::uint32_t sweeps) {
  const Probes& at = probes();
  SceneDescription scene = touchLiver();
  scene.solver.contactPasses = passes;
  scene.solver.contactIterations = sweeps;
  const std::unique_ptr<const Model> model = built(scene);
  SerialExecutor executor;
  Stepper stepper(*model, executor);
  DeformationAlone peer(*model, executor);
  stepper.precompute();
  std::vector<double> error;
  std::vector<double> residual;
  std::vector<double> left;
  for (auto _ : bench) {
    error.clear();
    residual.clear();
    left.clear();
    double whole = 0.0;
    double deformation = 0.0;
    for (const Probe& probe : at.probe) {
      State state = probe.before;
      std::vector<SolidState> organs = state.organ;
      stepper.invalidate();
      const double start = threadSeconds();
      const StepResult& result = stepper.step(state, at.motion.step[probe.step]);
      const double stepped = threadSeconds();
      peer.step(organs);
      deformation += threadSeconds() - stepped;
      whole += stepped - start;
      for (std::size_t h = 0; h < handCount; ++h) {
        error.push_back((result.hand[h].contactForce - probe.force[h]).norm() /
                        std::max(probe.force[h].norm(), leastForce));
      }
      residual.push_back(result.contact.residual);
      left.push_back(result.contact.error);
    }
    bench.SetIterationTime(whole / static_cast<double>(at.probe.size()));
    bench.counters["ratio"] = (whole - deformation) / deformation;
  }
  bench.counters["force_error_p50"] = quantile(error, 0.5);
  bench.counters["force_error_p99"] = quantile(error, 0.99);
  bench.counters["residual_p99_um"] = 1e6 * quantile(residual, 0.99);
  bench.counters["error_p99_um"] = 1e6 * quantile(left, 0.99);
  bench.counters["steps"] = static_cast<double>(at.probe.size());
}

}  // namespace

void registerContactBudget() {
  for (const std::uint32_t passes : {1U, 2U, 3U, 5U}) {
    const std::string name = "contact/budget/passes:" + std::to_string(passes);
    repeated(benchmark::RegisterBenchmark(name.c_str(), budget, passes, 100U), 3);
  }
  for (const std::uint32_t sweeps : {1U, 3U, 10U}) {
    const std::string name = "contact/budget/passes:3/sweeps:" + std::to_string(sweeps);
    repeated(benchmark::RegisterBenchmark(name.c_str(), budget, 3U, sweeps), 3);
  }
}

}  // namespace calot::bench
