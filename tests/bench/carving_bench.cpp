// SPDX-License-Identifier: GPL-3.0-or-later
// Carving: the closest point transform, a stroke, its surfaces; against full passes and OpenVDB.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/carving/carved_field.h"
#include "sim/carving/carved_surface.h"
#include "sim/geometry/closest_point_transform.h"
#include "sim/math/random.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/numbers.h"
#include "tests/bench/openvdb_peer.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench::carving_bench {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double band = 4.0;       // of the transform (cells)
constexpr double side = 0.048;     // of the lattice (m)
constexpr double radius = 0.0015;  // of the tool (m)
constexpr double wire = 0.004;     // its length (m)

/// A lump of fat, 40 x 32 x 18 mm at scale 1, with waves; twice as many triangles as rings times sectors, nearly.
TriangleMesh fat(int rings, int sectors, double scale = 1.0) {
  TriangleMesh mesh;
  const auto add = [&mesh, scale](const Vec3& d) {
    const double wave = 1.0 + 0.06 * std::sin(9.0 * d[0] + 1.0) * std::cos(8.0 * d[1]) + 0.04 * std::sin(11.0 * d[2]);
    mesh.vertex.emplace_back(scale * wave * Vec3(0.020 * d[0], 0.016 * d[1], 0.009 * d[2]));
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
  const auto at = [sectors](int j, int i) { return 1 + (j - 1) * sectors + i % sectors; };
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

/// Lattice of nodes^3 about the origin.
BrickLattice lattice(int nodes, double cell) {
  return {Vec3::Constant(-0.5 * cell * (nodes - 1)), cell, Index3::Constant(nodes)};
}

/// Twice as large as the fat, so that the surface of 20,000 triangles fills the lattice.
void transform(benchmark::State& bench) {
  TriangleMesh mesh = fat(71, 142);
  for (Vec3& p : mesh.vertex) p = p.cwiseProduct(Vec3(1.05, 1.3, 2.2));
  const BrickLattice nodes = lattice(128, side / 127.0);
  DistanceTransform field;
  double seconds = 0.0;
  for (auto _ : bench) {
    const double start = threadSeconds();
    field = closestPointTransform(mesh, nodes, band);
    seconds = threadSeconds() - start;
    bench.SetIterationTime(seconds);
  }
  if (!field.error.empty()) return bench.SkipWithError(field.error.c_str());
  bench.counters["triangles"] = mesh.triangles();
  std::int64_t inBand = 0;
  for (const double v : field.value) inBand += std::abs(v) < field.band ? 1 : 0;
  bench.counters["band_nodes"] = static_cast<double>(inBand);
  figures().add("cpt.20k_128.ms", 1e3 * seconds);
#ifdef CALOT_OPENVDB
  struct Context {
    const BrickLattice* lattice;
    const std::vector<double>* value;
  } context{&nodes, &field.value};
  const auto distance = [](const void* c, const Index3& n) {
    const auto& own = *static_cast<const Context*>(c);
    return own.lattice->contains(n) ? (*own.value)[own.lattice->node(n)] : 1e300;
  };
  const OpenvdbField peer = openvdbField(mesh, nodes.origin(), nodes.cell(), band, distance, &context);
  bench.counters["openvdb_us"] = 1e6 * peer.seconds;
  bench.counters["openvdb_voxels"] = static_cast<double>(peer.activeVoxels);
  bench.counters["openvdb_error_cells"] = peer.maxError;
  bench.counters["vs_openvdb"] = peer.seconds / seconds;
  figures().add("cpt.20k_128.vs_openvdb", peer.seconds / seconds);
#endif
}

/// A body and all that is kept in step with it.
struct Carving {
  FieldModel model;
  CarvedField field;
  CarvedBricks state;
  Islands islands;
  CarvedSurface surface;
  AdaptiveSurface adaptive;

  explicit Carving(FieldModel m)
      : model(std::move(m)),
        field(model),
        islands(model.lattice, anchors(model.lattice)),
        surface(model.lattice),
        adaptive(model.lattice) {
    field.reserve(state);
    islands.rebuild(field);
    surface.rebuild(field);
    adaptive.rebuild(field);
  }
  static FieldModel modelOf(const BrickLattice& nodes, double scale = 1.0) {
    const DistanceTransform t = closestPointTransform(fat(50, 100, scale), nodes, 3.0);
    return {nodes, t.band, t.value};
  }
  /// The underside is held.
  static std::vector<std::uint32_t> anchors(const BrickLattice& nodes) {
    std::vector<std::uint32_t> list;
    Index3 n;
    for (n[2] = 0; n[2] < nodes.nodes()[2]; ++n[2]) {
      if (nodes.position(n)[2] > -0.005) break;
      for (n[1] = 0; n[1] < nodes.nodes()[1]; ++n[1]) {
        for (n[0] = 0; n[0] < nodes.nodes()[0]; ++n[0]) list.push_back(nodes.node(n));
      }
    }
    return list;
  }
};

Vec3 direction(Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  const double z = random.normal();
  return Vec3(x, y, z).normalized();
}

struct Times {
  std::vector<double> step;      ///< carve, islands, State, fast surface (s)
  std::vector<double> adaptive;  ///< s
  std::vector<double> bricks;    ///< changed
  std::vector<double> share;     ///< adaptive triangles of the fast surface's
};

/// Strokes along the upper side, 1 to 2 mm each; those that take something off.
Times strokes(Carving& body, int count, double toolRadius, double scale = 1.0) {
  Random random(12, 3);
  Times times;
  const double overhead = clockOverhead();
  const double depth = carveDepth * body.model.lattice.cell();
  const UndeformedTissue tissue(body.model.lattice);
  for (int i = 0; i < count; ++i) {
    SweptCapsule c;
    c.radius = toolRadius;
    const double x = random.uniform(-0.015, 0.015);
    const double y = random.uniform(-0.011, 0.011);
    const double z = random.uniform(0.002, 0.008);
    c.p0 = scale * Vec3(x, y, z);
    const Vec3 axis = direction(random);
    c.p1 = c.p0 + wire * axis;
    const Vec3 way = direction(random);
    c.q0 = c.p0 + random.uniform(0.001, 0.002) * way;
    c.q1 = c.q0 + wire * axis;
    const std::array<SweptCapsule, 1> tool{c};
    const double start = threadSeconds();
    body.field.begin();
    const std::array<NodeBox, 1> box{nodesWithin(body.model.lattice, sweptBounds(tool, depth, 1.0))};
    carve(body.field, tool, box, tissue, depth);
    body.islands.remove(body.field);
    body.field.commit(body.state);
    body.surface.update(body.field);
    const double middle = threadSeconds();
    body.adaptive.update(body.field);
    const double end = threadSeconds();
    if (body.surface.changedBlocks().empty()) continue;
    times.step.push_back(middle - start - overhead);
    times.adaptive.push_back(end - middle - overhead);
    times.bricks.push_back(static_cast<double>(body.field.changed().size()));
    times.share.push_back(static_cast<double>(body.adaptive.triangles()) /
                          static_cast<double>(body.surface.triangles()));
  }
  return times;
}

void stroke(benchmark::State& bench) {
  const auto nodes = static_cast<int>(bench.range(0));
  static std::array<FieldModel, 2> models;
  FieldModel& model = models[nodes == 64 ? 0 : 1];
  if (model.value.empty()) model = Carving::modelOf(lattice(nodes, side / (nodes - 1)));
  Times times;
  double full = 0.0;
  double fullAdaptive = 0.0;
  for (auto _ : bench) {
    Carving body(model);
    times = strokes(body, 300, radius);
    CarvedSurface again(model.lattice);
    double start = threadSeconds();
    again.rebuild(body.field);
    full = threadSeconds() - start;
    AdaptiveSurface againAdaptive(model.lattice);
    start = threadSeconds();
    againAdaptive.rebuild(body.field);
    fullAdaptive = threadSeconds() - start;
    bench.SetIterationTime(quantile(times.step, 0.5));
  }
  const double median = quantile(times.step, 0.5);
  bench.counters["strokes"] = static_cast<double>(times.step.size());
  bench.counters["p99_us"] = 1e6 * quantile(times.step, 0.99);
  bench.counters["bricks"] = quantile(times.bricks, 0.5);
  bench.counters["adaptive_us"] = 1e6 * quantile(times.adaptive, 0.5);
  bench.counters["adaptive_share"] = quantile(times.share, 0.5);
  bench.counters["full_surface_us"] = 1e6 * full;
  bench.counters["full_adaptive_us"] = 1e6 * fullAdaptive;
  bench.counters["full_vs_stroke"] = full / median;
  const std::string name = "carve." + std::to_string(nodes);
  figures().add(name + ".median_ms", 1e3 * median);
  figures().add(name + ".adaptive_ms", 1e3 * quantile(times.adaptive, 0.5));
  figures().add(name + ".adaptive_share", quantile(times.share, 0.5));
}

/// At fixed cell: over the tool's radius (changed bricks), and over the size of body and lattice (the rest).
void growth(benchmark::State& bench) {
  const double cell = side / 127.0;
  std::vector<double> bricks;
  std::vector<double> byTool;
  std::vector<double> sizes;
  std::vector<double> bySize;
  for (auto _ : bench) {
    bricks.clear();
    byTool.clear();
    sizes.clear();
    bySize.clear();
    for (const double r : {0.001, 0.0015, 0.002, 0.003, 0.004}) {
      Carving body(Carving::modelOf(lattice(128, cell)));
      const Times times = strokes(body, 60, r);
      bricks.push_back(quantile(times.bricks, 0.5));
      byTool.push_back(quantile(times.step, 0.5));
    }
    for (const int nodes : {96, 128, 160, 192}) {
      const double scale = nodes / 128.0;
      Carving body(Carving::modelOf(lattice(nodes, cell), scale));
      const Times times = strokes(body, 60, radius, scale);
      sizes.push_back(static_cast<double>(nodes) * nodes * nodes);
      bySize.push_back(quantile(times.step, 0.5));
      bench.counters["us_" + std::to_string(nodes)] = 1e6 * bySize.back();
    }
    bench.SetIterationTime(byTool.back());
  }
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    bench.counters["us_at_" + std::to_string(static_cast<int>(bricks[i])) + "_bricks"] = 1e6 * byTool[i];
  }
  bench.counters["exponent_bricks"] = growthExponent(bricks, byTool);
  bench.counters["exponent_lattice_nodes"] = growthExponent(sizes, bySize);
  figures().add("growth.bricks.exponent", growthExponent(bricks, byTool));
}

}  // namespace
}  // namespace calot::bench::carving_bench

void calot::bench::registerCarving() {
  using namespace carving_bench;

  repeated(benchmark::RegisterBenchmark("carving/transform/20k_128", transform), 9);
  repeated(benchmark::RegisterBenchmark("carving/stroke", stroke)->Arg(64)->Arg(128), 5);
  repeated(benchmark::RegisterBenchmark("carving/growth", growth), 3);
}
