// SPDX-License-Identifier: GPL-3.0-or-later
// Deformation alone on boxes: time against error. A box of jittered tetrahedra (Kuhn's, 15 % inside), one face held,
// E = 5 kPa, nu = 0.45, hangs in gravity, and a load of 1 N goes to and fro over its free end; steps of 20 ms. The peer
// is Bullet's deformable body (neo-Hookean, float) on the same box in the same run. The error is that of the solver
// alone, each code held against itself, converged, at the same step: root mean square over the nodes, relative to that
// of their displacement.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/bench/benchmarks.h"
#include "tests/bench/bullet_peer.h"
#include "tests/bench/figures.h"
#include "tests/bench/hanging_box.h"
#include "tests/bench/repeated.h"

namespace calot::bench {

namespace {

constexpr double wantedError = 1e-3;
constexpr double tolerances[] = {1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5};

double errorOf(const HangingBody& body, const std::vector<Vec3>& position, const std::vector<Vec3>& exact) {
  double wrong = 0.0;
  double moved = 0.0;
  for (std::size_t n = 0; n < exact.size(); ++n) {
    wrong += (position[n] - exact[n]).squaredNorm();
    moved += (exact[n] - body.node[n]).squaredNorm();
  }
  return std::sqrt(wrong / moved);
}

void boxes(benchmark::State& bench, const BoxSize& size) {
  const HangingBody body = hangingBox(size, HangingBox::soft);
  const SolidModel model = modelOf(body);
  const Own exact = hangOurs(model, body, size.steps, 1e-7);
  // The loosest tolerance that is good enough here.
  double error = 1.0;
  double tolerance = 0.0;
  for (const double t : tolerances) {
    tolerance = t;
    error = errorOf(body, hangOurs(model, body, size.steps, t).hung.position, exact.hung.position);
    if (error <= wantedError) break;
  }
  Own own;
  for (auto _ : bench) {
    own = hangOurs(model, body, size.steps, tolerance);
    bench.SetIterationTime(own.hung.seconds);
  }
  auto& counters = bench.counters;
  counters["tolerance"] = tolerance;
  counters["iterations"] = own.iterations;
  counters["error"] = error;
  counters["all_converged"] = own.converged ? 1.0 : 0.0;
  const std::string name = "boxes." + std::to_string(size.tetrahedra);
  figures().add(name + ".steps_per_s", 1.0 / own.hung.seconds);
  figures().add(name + ".error", error);
  const HangingBody plain = hangingBox(size, HangingBox::framework);
  const double plainMs = 1e3 * hangOurs(modelOf(plain), plain, size.steps, tolerance).hung.seconds;
  counters["framework_box_ms"] = plainMs;
  counters["over_framework"] = size.frameworkMs / plainMs;
  figures().add(name + ".vs_framework", size.frameworkMs / plainMs);
#ifdef CALOT_BULLET
  if (size.peerSteps == 0) return;
  const Own beside = hangOurs(model, body, size.peerSteps, tolerance);
  const Hung peer = hangInBullet(body, size.peerSteps, BulletBudget{});
  counters["bullet_ms"] = 1e3 * peer.seconds;
  counters["vs_bullet"] = peer.seconds / beside.hung.seconds;
  figures().add(name + ".vs_bullet", peer.seconds / beside.hung.seconds);
  if (size.tetrahedra == 1500) figures().add("deformation.B.vs_bullet", peer.seconds / beside.hung.seconds);
#endif
}

/// Ours at several tolerances and, where Bullet is there, its body at several budgets: a line each of the diagram.
void precision(benchmark::State& bench, const BoxSize& size) {
  const HangingBody body = hangingBox(size, HangingBox::stiff);
  const SolidModel model = modelOf(body);
  constexpr int steps = 25;
  const std::vector<Vec3> exact = hangOurs(model, body, steps, 1e-7).hung.position;
  auto& counters = bench.counters;
  const std::string name = "precision." + std::to_string(size.tetrahedra);
  const auto put = [&](const std::string& key, const Hung& hung, const std::vector<Vec3>& reference) {
    const double error = errorOf(body, hung.position, reference);
    counters[key + "_ms"] = 1e3 * hung.seconds;
    counters[key + "_error"] = error;
    figures().add(name + "." + key + ".ms", 1e3 * hung.seconds);
    figures().add(name + "." + key + ".error", error);
  };
  for (auto _ : bench) {
    double spent = 0.0;
    for (const int digits : {1, 2, 3, 4, 5}) {
      const Own own = hangOurs(model, body, steps, std::pow(10.0, -digits));
      put("ours_1e-" + std::to_string(digits), own.hung, exact);
      spent += own.hung.seconds;
    }
    bench.SetIterationTime(spent);
  }
#ifdef CALOT_BULLET
  // Newton's steps and iterations far beyond what any budget takes.
  const std::vector<Vec3> peerExact = hangInBullet(body, steps, BulletBudget{8, 400, 1e-10}).position;
  put("bullet", hangInBullet(body, steps, BulletBudget{}), peerExact);
  for (const int iterations : {10, 50, 200}) {
    put("bullet_1x" + std::to_string(iterations), hangInBullet(body, steps, BulletBudget{1, iterations, 1e-8}),
        peerExact);
  }
  put("bullet_3x200", hangInBullet(body, steps, BulletBudget{3, 200, 1e-8}), peerExact);
#endif
}

}  // namespace

void registerBoxes() {
  for (const BoxSize& size : boxSizes) {
    const std::string name = std::to_string(size.tetrahedra);
    repeated(benchmark::RegisterBenchmark(("boxes/" + name).c_str(), boxes, size), 3);
    if (size.tetrahedra == 1500 || size.tetrahedra == 5040) {
      repeated(benchmark::RegisterBenchmark(("precision/" + name).c_str(), precision, size), 1);
    }
  }
}

}  // namespace calot::bench
