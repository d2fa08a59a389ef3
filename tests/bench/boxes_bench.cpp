// SPDX-License-Identifier: GPL-3.0-or-later
// Deformation alone on boxes: time against error. A box of jittered tetrahedra (Kuhn's, 15 % inside), one face held,
// E = 5 kPa, nu = 0.45, hangs in a gravity that swings; steps of 20 ms. The peer is Bullet's deformable body
// (neo-Hookean, float) on the same box in the same run. The error is that of the solver alone, each code held against
// itself, converged, at the same step: root mean square over the nodes, relative to that of their displacement.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "sim/math/random.h"
#include "sim/solid/solid.h"
#include "tests/accuracy/support/kuhn_box.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/bullet_peer.h"
#include "tests/bench/figures.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench {

namespace {

struct Size {
  int tetrahedra, nx, ny, nz;
  int steps;      ///< measured, of ours
  int peerSteps;  ///< measured, of the peer; 0: it takes too long
};
constexpr Size sizes[] = {{504, 7, 4, 3, 100, 60},     {1500, 10, 5, 5, 100, 60},  {5040, 15, 8, 7, 60, 40},
                          {10800, 18, 10, 10, 60, 40}, {49152, 32, 16, 16, 20, 0}, {202800, 50, 26, 26, 8, 0}};
constexpr double wantedError = 1e-3;
constexpr double tolerances[] = {1e-3, 3e-4, 1e-4, 3e-5, 1e-5};

HangingBody hangingBox(const Size& size, bool swinging) {
  const test::KuhnBox box =
      test::kuhnBox(size.nx, size.ny, size.nz, Vec3(0.0, -0.0375, -0.0375), Vec3(0.15, 0.0375, 0.0375));
  HangingBody body;
  body.node = box.node;
  body.tetrahedron = box.tetrahedron;
  body.fixed.assign(box.node.size(), false);
  const Vec3 cell(0.15 / size.nx, 0.075 / size.ny, 0.075 / size.nz);
  Random random(7);
  for (int k = 0; k <= size.nz; ++k) {
    for (int j = 0; j <= size.ny; ++j) {
      for (int i = 0; i <= size.nx; ++i) {
        const auto n = static_cast<std::size_t>(box.index(i, j, k));
        body.fixed[n] = i == 0;
        if (i == 0 || i == size.nx || j == 0 || j == size.ny || k == 0 || k == size.nz) continue;
        for (int a = 0; a < 3; ++a) body.node[n][a] += 0.15 * cell[a] * (2.0 * random.uniform() - 1.0);
      }
    }
  }
  if (!swinging) {
    body.youngModulus = 50e3;
    body.gravity = [](int) { return Vec3(0.0, -9.81, 0.0); };
    return body;
  }
  body.gravity = [](int step) { return Vec3(0.0, step / 10 % 2 == 0 ? -9.81 : 4.0, step / 7 % 2 == 0 ? 3.0 : -3.0); };
  return body;
}

struct Own {
  Hung hung;
  double iterations = 0.0;
  bool converged = true;
};

Own hangOurs(const SolidModel& model, const HangingBody& body, int steps, double tolerance) {
  SerialExecutor executor;
  SolidSolver solver;
  SolidSolver::Settings settings;
  settings.step = body.step;
  settings.tolerance = tolerance;
  settings.cap = 4000;
  SolidState state = restState(model);
  Own own;
  for (int n = 0; n < steps; ++n) {
    const double begin = threadSeconds();
    const SolveReport report = solver.freeMotion(model, state, body.gravity(n), {}, settings, executor);
    solver.advance(model, state, {}, settings.step);
    own.hung.seconds += (threadSeconds() - begin) / steps;
    own.iterations += static_cast<double>(report.iterations) / steps;
    own.converged = own.converged && report.converged;
  }
  own.hung.position = state.position;
  return own;
}

double errorOf(const HangingBody& body, const std::vector<Vec3>& position, const std::vector<Vec3>& exact) {
  double wrong = 0.0;
  double moved = 0.0;
  for (std::size_t n = 0; n < exact.size(); ++n) {
    wrong += (position[n] - exact[n]).squaredNorm();
    moved += (exact[n] - body.node[n]).squaredNorm();
  }
  return std::sqrt(wrong / moved);
}

SolidModel modelOf(const HangingBody& body) {
  return {body.node,
          body.tetrahedron,
          body.fixed,
          {lameConstants(body.youngModulus, body.poissonRatio), body.density, 0.0, 0.0}};
}

void boxes(benchmark::State& bench, const Size& size) {
  const HangingBody body = hangingBox(size, true);
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
void precision(benchmark::State& bench, const Size& size) {
  const HangingBody body = hangingBox(size, false);
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
  for (const Size& size : sizes) {
    const std::string name = std::to_string(size.tetrahedra);
    repeated(benchmark::RegisterBenchmark(("boxes/" + name).c_str(), boxes, size), 3);
    if (size.tetrahedra == 1500 || size.tetrahedra == 5040) {
      repeated(benchmark::RegisterBenchmark(("precision/" + name).c_str(), precision, size), 1);
    }
  }
}

}  // namespace calot::bench
