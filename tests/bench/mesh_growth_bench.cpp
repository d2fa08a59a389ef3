// SPDX-License-Identifier: GPL-3.0-or-later
// Deformation alone against the size of the mesh: the liver of touch-liver from the paper's case A to twenty times its
// case E, hung up by its anchors under a gravity that swings. The peer is case B in the same run.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/numbers.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"
#include "tests/bench/touch_motion.h"

namespace calot::bench {

namespace {

constexpr std::uint32_t sizes[] = {518, 1489, 2030, 5024, 10615, 50000, 200000};
constexpr std::uint32_t peerSize = 1489;

struct Swing {
  double seconds = 0.0;  ///< CPU, a step
  double iterations = 0.0;
  double largest = 0.0;  ///< displacement (m)
  bool converged = true;
};

Swing swing(const Model& model, int steps) {
  const SolidModel& solid = model.organs()[0].solid;
  SerialExecutor executor;
  SolidSolver solver;
  SolidSolver::Settings settings;
  settings.step = model.stepSeconds();
  settings.tolerance = model.scene().solver.tolerance;
  settings.cap = model.scene().solver.iterations;
  SolidState state = restState(solid);
  Swing out;
  constexpr int warm = 3;
  for (int n = 0; n < warm + steps; ++n) {
    const Vec3 gravity(0.0, n / 10 % 2 == 0 ? -9.81 : 4.0, n / 7 % 2 == 0 ? 3.0 : -3.0);
    const double begin = threadSeconds();
    const SolveReport report = solver.solveUnconstrained(solid, state, gravity, {}, settings, executor);
    solver.advance(solid, state, {}, settings.step);
    if (n < warm) continue;
    out.seconds += (threadSeconds() - begin) / steps;
    out.iterations += static_cast<double>(report.iterations) / steps;
    out.converged = out.converged && report.converged;
  }
  for (std::size_t n = 0; n < solid.nodes(); ++n) {
    out.largest = std::max(out.largest, (state.position[n] - solid.rest()[n]).norm());
  }
  return out;
}

std::unique_ptr<const Model> liverOf(std::uint32_t tetrahedra) {
  SceneDescription scene = touchLiver();
  std::erase_if(scene.organs, [](const OrganDescription& organ) { return organ.name != "liver"; });
  scene.connective.clear();
  scene.organs.front().tetrahedra = tetrahedra;
  return built(scene);
}

void meshSize(benchmark::State& bench, std::uint32_t size) {
  const std::unique_ptr<const Model> model = liverOf(size);
  const std::unique_ptr<const Model> peer = liverOf(peerSize);
  const int steps = size > 20000 ? 10 : 60;
  Swing own;
  for (auto _ : bench) {
    own = swing(*model, steps);
    bench.SetIterationTime(own.seconds);
  }
  const Swing beside = swing(*peer, 60);
  const SolidModel& solid = model->organs()[0].solid;
  auto& counters = bench.counters;
  const auto tetrahedra = static_cast<double>(solid.tetrahedra().size());
  counters["tetrahedra"] = tetrahedra;
  counters["iterations"] = own.iterations;
  counters["all_converged"] = own.converged ? 1.0 : 0.0;
  counters["droop_mm"] = 1e3 * own.largest;
  counters["matrix_mb"] = 1e-6 * 4.0 * static_cast<double>(solid.system().matrix().valueCount());
  counters["over_case_b"] = own.seconds / beside.seconds;
  // 1: as the number of tetrahedra; the rest is more iterations, and slower memory.
  counters["exponent"] =
      size == peerSize ? 1.0
                       : std::log(own.seconds / beside.seconds) /
                             std::log(tetrahedra / static_cast<double>(peer->organs()[0].solid.tetrahedra().size()));
  figures().add("mesh." + std::to_string(size) + ".step_ms", 1e3 * own.seconds);
  if (size == 200000) figures().add("deformation.200k.steps_per_s", 1.0 / own.seconds);
}

/// Time of a step over tetrahedra, fitted over all sizes to fifty thousand; and what of it is more iterations.
void elementGrowth(benchmark::State& bench) {
  std::vector<double> tetrahedra;
  std::vector<std::unique_ptr<const Model>> models;
  for (const std::uint32_t size : sizes) {
    if (size > 50000) continue;
    models.push_back(liverOf(size));
    tetrahedra.push_back(static_cast<double>(models.back()->organs()[0].solid.tetrahedra().size()));
  }
  for (auto _ : bench) {
    std::vector<double> seconds;
    std::vector<double> iterations;
    for (const auto& model : models) {
      const Swing own = swing(*model, model->organs()[0].solid.tetrahedra().size() > 20000 ? 10 : 60);
      seconds.push_back(own.seconds);
      iterations.push_back(own.iterations);
    }
    bench.SetIterationTime(seconds.back());
    bench.counters["exponent"] = growthExponent(tetrahedra, seconds);
    bench.counters["exponent_iterations"] = growthExponent(tetrahedra, iterations);
    figures().add("growth.elements.exponent", growthExponent(tetrahedra, seconds));
  }
}

}  // namespace

void registerMeshGrowth() {
  repeated(benchmark::RegisterBenchmark("growth/elements", elementGrowth), 3);
  for (const std::uint32_t size : sizes) {
    repeated(benchmark::RegisterBenchmark(("mesh/liver/" + std::to_string(size)).c_str(), meshSize, size), 3);
  }
}

}  // namespace calot::bench
