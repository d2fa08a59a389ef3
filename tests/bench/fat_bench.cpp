// SPDX-License-Identifier: GPL-3.0-or-later
// Fat in a step: its motion, its surface for contact, a stroke.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "sim/contact/broad_phase.h"
#include "sim/fat/fat_body.h"
#include "sim/fat/fat_model.h"
#include "sim/math/executor.h"
#include "sim/math/random.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/numbers.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench::fat_bench {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double gravity = -1.0;  // m/s^2: enough to keep it awake

/// An ellipsoid with waves.
TriangleMesh lump(const Vec3& half) {
  constexpr int rings = 50;
  constexpr int sectors = 100;
  TriangleMesh mesh;
  const auto add = [&](const Vec3& d) {
    const double wave = 1.0 + 0.06 * std::sin(9.0 * d[0] + 1.0) * std::cos(8.0 * d[1]);
    mesh.vertex.emplace_back(wave * half.cwiseProduct(d));
  };
  add(Vec3::UnitZ());
  for (int j = 1; j < rings; ++j) {
    for (int i = 0; i < sectors; ++i) {
      const double a = pi * j / rings;
      const double b = 2.0 * pi * i / sectors;
      add({std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)});
    }
  }
  add(-Vec3::UnitZ());
  const int last = mesh.vertices() - 1;
  const auto at = [](int j, int i) { return 1 + (j - 1) * sectors + i % sectors; };
  for (int i = 0; i < sectors; ++i) {
    mesh.triangle.emplace_back(0, at(1, i), at(1, i + 1));
    mesh.triangle.emplace_back(last, at(rings - 1, i + 1), at(rings - 1, i));
    for (int j = 1; j + 1 < rings; ++j) {
      mesh.triangle.emplace_back(at(j, i), at(j + 1, i), at(j + 1, i + 1));
      mesh.triangle.emplace_back(at(j, i), at(j + 1, i + 1), at(j, i + 1));
    }
  }
  return mesh;
}

/// 0: 4 cm^3 at 0.75 mm, cubes of 2.25 mm. 1: 12 cm^3 in a lattice of about 128^2 x 64 at 0.38 mm, the same cubes.
std::unique_ptr<const FatModel> fatModel(int which) {
  const Vec3 half = which == 0 ? Vec3(0.014, 0.012, 0.006) : Vec3(0.020, 0.016, 0.009);
  FatSettings settings;
  settings.cell = which == 0 ? 0.00075 : 0.000375;
  settings.cellsPerCube = which == 0 ? 3 : 6;
  settings.material.lame = lameConstants(1000.0, 0.4);
  settings.material.density = 920.0;
  settings.material.massDamping = 2.0;
  settings.material.stiffnessDamping = 0.01;
  FatPartner floor;
  floor.name = "floor";
  floor.distance = [half](const Vec3& p) { return p[2] + 0.6 * half[2]; };
  floor.reach = 0.0;
  std::string error;
  return FatModel::make(lump(half), settings, {&floor, 1}, {}, error);
}

Vec3 direction(Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  const double z = random.normal();
  return Vec3(x, y, z).normalized();
}

/// A hook's wire that sweeps by 1 to 2 mm.
SweptCapsule sweep(Random& random, const Vec3& half) {
  SweptCapsule c;
  c.radius = 0.0015;
  const double x = random.uniform(-0.7, 0.7);
  const double y = random.uniform(-0.7, 0.7);
  const double z = random.uniform(0.2, 0.9);
  c.p0 = half.cwiseProduct(Vec3(x, y, z));
  const Vec3 axis = direction(random);
  c.p1 = c.p0 + 0.004 * axis;
  c.q0 = c.p0 + random.uniform(0.001, 0.002) * direction(random);
  c.q1 = c.q0 + 0.004 * axis;
  return c;
}

/// Motion, surface and bounds in every step; a stroke in each where `strokes`.
void fatSteps(benchmark::State& bench, bool strokes) {
  const auto which = static_cast<int>(bench.range(0));
  static std::array<std::unique_ptr<const FatModel>, 2> models;
  std::unique_ptr<const FatModel>& model = models[static_cast<std::size_t>(which)];
  if (model == nullptr) model = fatModel(which);
  const Vec3 half = which == 0 ? Vec3(0.014, 0.012, 0.006) : Vec3(0.020, 0.016, 0.009);
  std::vector<double> stroke;
  std::vector<double> move;
  std::vector<double> skinMap;
  std::vector<double> bounding;
  std::vector<double> drawn;
  std::vector<double> whole;
  std::vector<double> iterations;
  for (auto _ : bench) {
    for (auto* list : {&stroke, &move, &skinMap, &bounding, &drawn, &whole, &iterations}) list->clear();
    FatBody body(*model);
    FatState state = restState(*model);
    FatPicture picture(*model);
    std::vector<Vec3> pictured;
    SolidSolver solver;
    SerialExecutor executor;
    const SolidSolver::Settings settings;
    std::vector<Attachment> ties;
    std::vector<Vec3> skin;
    std::vector<Box> bounds;
    std::vector<Box> before;
    std::vector<std::uint32_t> changed;
    SortedGrid broad(0.02);
    Random random(11, 3);
    for (int i = 0; i < 200; ++i) {
      const double start = threadSeconds();
      body.beginStep(state);
      ties.clear();
      for (std::size_t t = 0; t < model->allTies().size(); ++t) {
        const FatTie& tie = model->allTies()[t];
        const double share = body.tieShare(t);
        if (share == 0.0) continue;
        ties.push_back({tie.point, share * tie.stiffness * (tie.rest - tie.point.of(state.solid.position)),
                        share * (settings.step * tie.stiffness + tie.damping) * Mat3::Identity()});
      }
      const SolveReport report =
          solver.solveUnconstrained(model->solid(), state.solid, {0.0, 0.0, i % 40 < 20 ? gravity : -gravity}, {},
                                    settings, executor, {ties, body.fill()});
      solver.advance(model->solid(), state.solid, {}, settings.step);
      iterations.push_back(report.iterations);
      const double moved = threadSeconds();
      bool cut = false;
      if (strokes) {
        const SweptCapsule tool[1] = {sweep(random, half)};
        cut = body.stroke(state, tool).changed;
      }
      const double carved = threadSeconds();
      body.contact().positions(state.solid.position, skin);
      const double mapped = threadSeconds();
      before.swap(bounds);
      patchBounds(body.contact().surface(), skin, 0.0, bounds);
      if (before.size() == bounds.size()) {
        changedBounds(before, bounds, changed);
        broad.refit(bounds, changed);
      } else {
        broad.update(bounds);
      }
      const double end = threadSeconds();
      if (cut) {
        const double asked = threadSeconds();
        picture.update(state.carved);
        picture.positions(state.solid.position, pictured);
        drawn.push_back(threadSeconds() - asked);
      }
      move.push_back(moved - start);
      if (cut) stroke.push_back(carved - moved);
      skinMap.push_back(mapped - carved);
      bounding.push_back(end - mapped);
      whole.push_back(end - start);
    }
    bench.SetIterationTime(quantile(whole, 0.5));
    bench.counters["triangles"] = static_cast<double>(body.surface().triangles());
    bench.counters["patches"] = static_cast<double>(body.surface().patches());
  }
  const auto mean = [](const std::vector<double>& v) {
    double sum = 0.0;
    for (const double x : v) sum += x;
    return sum / static_cast<double>(v.size());
  };
  bench.counters["cubes"] = static_cast<double>(model->solid().cubes().size());
  bench.counters["move_us"] = 1e6 * mean(move);
  bench.counters["iterations"] = mean(iterations);
  bench.counters["ties"] = static_cast<double>(model->allTies().size());
  bench.counters["skin_us"] = 1e6 * mean(skinMap);
  bench.counters["bounds_us"] = 1e6 * mean(bounding);
  bench.counters["whole_us"] = 1e6 * mean(whole);
  const std::string name = which == 0 ? "fat.075mm" : "fat.0375mm";
  if (strokes) {
    bench.counters["strokes"] = static_cast<double>(stroke.size());
    bench.counters["stroke_us"] = 1e6 * quantile(stroke, 0.5);
    bench.counters["stroke_p99_us"] = 1e6 * quantile(stroke, 0.99);
    bench.counters["picture_us"] = 1e6 * quantile(drawn, 0.5);
    figures().add(name + ".stroke_ms", 1e3 * quantile(stroke, 0.5));
  } else {
    figures().add(name + ".step_ms", 1e3 * mean(whole));
  }
}

}  // namespace
}  // namespace calot::bench::fat_bench

void calot::bench::registerFat() {
  using namespace fat_bench;

  repeated(benchmark::RegisterBenchmark("fat/step", [](benchmark::State& b) { fatSteps(b, false); })->Arg(0)->Arg(1),
           3);
  repeated(benchmark::RegisterBenchmark("fat/stroke", [](benchmark::State& b) { fatSteps(b, true); })->Arg(0)->Arg(1),
           3);
}
