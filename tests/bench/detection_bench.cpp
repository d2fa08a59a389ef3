// SPDX-License-Identifier: GPL-3.0-or-later
// Narrow phase: lanes against the plain scalar distance. Broad phase: our grid against Bullet's trees.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "sim/contact/broad_phase.h"
#include "sim/contact/triangle_lanes.h"
#include "sim/geometry/closest_point.h"
#include "sim/math/random.h"
#include "sim/scene/model.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/numbers.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"
#include "tests/bench/touch_motion.h"
#ifdef CALOT_BULLET
#include "sim/bullet/bullet_tree.h"
#endif

namespace calot::bench::detection_bench {

namespace {

constexpr int rounds = 200;

const OrganModel& liver() {
  static const std::unique_ptr<const Model> model = built(touchLiver());
  return model->organs().front();
}

/// Pieces of an instrument (2 cm) that end within 5 mm of the liver's surface.
std::vector<std::array<Vec3, 2>> piecesNearLiver(std::size_t count) {
  Random random(71);
  std::vector<std::array<Vec3, 2>> pieces;
  const auto number = static_cast<double>(liver().skin.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& at = liver().skin[static_cast<std::size_t>(random.uniform() * number)];
    const Vec3 way = Vec3(random.normal(), random.normal(), random.normal()).normalized();
    pieces.push_back({at + 0.005 * random.uniform() * way, at + 0.025 * way});
  }
  return pieces;
}

/// Seconds of `rounds` calls.
template <class F>
double timed(F&& call) {
  const double start = threadSeconds();
  for (int r = 0; r < rounds; ++r) call(r);
  return threadSeconds() - start;
}

/// All of the liver's triangles, eight at a time, against one piece or point, beside the same one by one.
void narrow(benchmark::State& bench, bool points) {
  const std::vector<Index3>& triangle = liver().surface.triangles();
  const std::vector<Vec3>& skin = liver().skin;
  std::vector<TriangleLanes> lanes;
  std::vector<std::array<Vec3, 3>> plain;
  for (std::uint32_t t = 0; t + laneCount <= triangle.size(); t += laneCount) {
    std::array<std::uint32_t, laneCount> eight{};
    for (std::uint32_t k = 0; k < laneCount; ++k) {
      eight[k] = t + k;
      const Index3& corner = triangle[t + k];
      plain.push_back({skin[static_cast<std::size_t>(corner[0])], skin[static_cast<std::size_t>(corner[1])],
                       skin[static_cast<std::size_t>(corner[2])]});
    }
    gatherTriangles(liver().surface, skin, eight, lanes.emplace_back());
  }
  const auto pieces = piecesNearLiver(rounds);
  const double triangles = static_cast<double>(plain.size()) * rounds;
  double ratio = 0.0;
  double scalar = 0.0;
  for (auto _ : bench) {
    LaneValues squared{};
    const double wide = timed([&](int r) {
      const auto& [p0, p1] = pieces[static_cast<std::size_t>(r)];
      for (const TriangleLanes& eight : lanes) {
        if (points) {
          pointTriangleDistances(eight, p0, squared);
        } else {
          segmentTriangleDistances(eight, p0, p1, squared);
        }
        benchmark::DoNotOptimize(squared);
      }
    });
    scalar = timed([&](int r) {
      const auto& [p0, p1] = pieces[static_cast<std::size_t>(r)];
      for (const auto& [a, b, c] : plain) {
        if (points) {
          benchmark::DoNotOptimize(closestOnTriangle(p0, a, b, c).squaredDistance);
        } else {
          benchmark::DoNotOptimize(closestSegmentTriangle(p0, p1, a, b, c).squaredDistance);
        }
      }
    });
    ratio = scalar / wide;
    bench.counters["ns_a_triangle"] = 1e9 * wide / triangles;
    bench.SetIterationTime(wide / rounds);
  }
  bench.counters["scalar_ns"] = 1e9 * scalar / triangles;
  bench.counters["times_faster"] = ratio;
}

enum class BroadWork : std::uint8_t { update, refitTenth, query };

/// Seconds of one piece of work of a broad phase over the liver's patches.
double broadSeconds(BroadPhase& broad, BroadWork work) {
  std::vector<Box> leaves;
  patchBounds(liver().surface, liver().skin, 0.0, leaves);
  std::vector<Box> moved = leaves;
  std::vector<std::uint32_t> changed;
  for (std::uint32_t l = 0; l < leaves.size(); l += 10) {
    moved[l].lower.array() += 0.001;
    moved[l].upper.array() += 0.001;
    changed.push_back(l);
  }
  std::vector<Box> queries;
  for (const auto& [p0, p1] : piecesNearLiver(rounds)) {
    Box box;
    box.include(p0);
    box.include(p1);
    box.grow(0.0035);
    queries.push_back(box);
  }
  std::vector<BroadPhase::Pair> pairs;
  broad.update(leaves);
  return timed([&](int r) {
           if (work == BroadWork::update) broad.update(r % 2 == 0 ? moved : leaves);
           if (work == BroadWork::refitTenth) broad.refit(r % 2 == 0 ? moved : leaves, changed);
           if (work == BroadWork::query) broad.pairs({&queries[static_cast<std::size_t>(r)], 1}, pairs);
           benchmark::DoNotOptimize(pairs);
         }) /
         rounds;
}

void broad(benchmark::State& bench, BroadWork work) {
  for (auto _ : bench) {
    SortedGrid grid(0.02);
    const double ours = broadSeconds(grid, work);
    bench.SetIterationTime(ours);
    bench.counters["grid_us"] = 1e6 * ours;
#ifdef CALOT_BULLET
    BulletTree tree;
    const double bullets = broadSeconds(tree, work);
    bench.counters["bullet_us"] = 1e6 * bullets;
    bench.counters["times_bullet"] = ours / bullets;
#endif
  }
  bench.counters["patches"] = static_cast<double>(liver().surface.patches().size());
}

}  // namespace
}  // namespace calot::bench::detection_bench

void calot::bench::registerDetection() {
  using namespace detection_bench;

  repeated(benchmark::RegisterBenchmark("contact/narrow/segment", narrow, false), 5);
  repeated(benchmark::RegisterBenchmark("contact/narrow/point", narrow, true), 5);
  repeated(benchmark::RegisterBenchmark("contact/broad/update", broad, BroadWork::update), 5);
  repeated(benchmark::RegisterBenchmark("contact/broad/refit_tenth", broad, BroadWork::refitTenth), 5);
  repeated(benchmark::RegisterBenchmark("contact/broad/query", broad, BroadWork::query), 5);
}
