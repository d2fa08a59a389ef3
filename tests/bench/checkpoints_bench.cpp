// SPDX-License-Identifier: GPL-3.0-or-later
// All motion checkpoints of both hands over ten minutes of ticks, against one pass of path length alone.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/phases.h"
#include "sim/math/random.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench::checkpoints_bench {

namespace {

using analytics::AttemptContext;
using analytics::AttemptEnd;
using analytics::Motion;
using analytics::MotionTrack;

constexpr std::size_t ticks = 600000;
constexpr double tickSeconds = 0.001;

using Tick = std::array<InstrumentSample, handCount>;

/// Both hands reach about, tremble and turn; every tick is a sample, which costs most.
std::vector<Tick> tenMinutes() {
  Random random(31, 1);
  std::array<std::array<double, 6>, handCount> phase{};
  for (auto& hand : phase) {
    for (double& p : hand) p = random.uniform(0.0, 6.0);
  }
  std::vector<Tick> all(ticks);
  for (std::size_t t = 0; t < ticks; ++t) {
    const double time = tickSeconds * static_cast<double>(t);
    for (std::size_t h = 0; h < all[t].size(); ++h) {
      const auto& p = phase[h];
      const double tremor = 0.0001 * std::sin(60.0 * time + p[3]);
      all[t][h].position = Vec3(0.04 * std::sin(1.9 * time + p[0]) + tremor, 0.03 * std::sin(2.7 * time + p[1]),
                                0.02 * std::sin(1.1 * time + p[2]) + tremor);
      const double angle = 0.5 * std::sin(0.8 * time + p[4]);
      all[t][h].orientation = Quat(std::cos(angle), 0.0, std::sin(angle), 0.0);
    }
  }
  return all;
}

/// The motion of both hands from their ticks.
std::array<Motion, handCount> motionsOf(const std::vector<Tick>& all) {
  std::array<MotionTrack, handCount> track{MotionTrack(tickSeconds), MotionTrack(tickSeconds)};
  for (const Tick& tick : all) {
    for (std::size_t h = 0; h < tick.size(); ++h) track[h].add(tick[h]);
  }
  return {track[0].motion(), track[1].motion()};
}

/// Values of those checkpoints whose name passes.
template <class Wanted>
std::size_t valuesOf(const std::array<Motion, handCount>& motion, Wanted wanted) {
  const std::vector<analytics::PhaseMotion> phases;
  const analytics::ForceTrack force(tickSeconds);
  AttemptEnd end;
  end.motion = {&motion[0], &motion[1]};
  end.phases = &phases;
  end.force = &force;
  std::size_t values = 0;
  for (const analytics::CheckpointEntry& entry : analytics::checkpointRegistry()) {
    if (!wanted(entry.definition)) continue;
    for (const analytics::CheckpointValue& v : entry.make(AttemptContext())->values(end)) values += v.value ? 1 : 0;
  }
  return values;
}

bool isMotion(const analytics::CheckpointDefinition& d) {
  return d.filter == analytics::motionFilterText() && d.aggregation != analytics::Aggregation::handAndPhase;
}

/// Path length of the ticks as they come, unfiltered: the least that any reader of a motion does.
double plainPath(const std::vector<Tick>& all) {
  double length = 0.0;
  for (std::size_t t = 1; t < all.size(); ++t) {
    for (std::size_t h = 0; h < all[t].size(); ++h) length += (all[t][h].position - all[t - 1][h].position).norm();
  }
  return length;
}

void motion(benchmark::State& bench) {
  static const std::vector<Tick> all = tenMinutes();
  double whole = 0.0, filtering = 0.0, path = 0.0, plain = 0.0;
  std::size_t values = 0;
  for (auto _ : bench) {
    const double start = threadSeconds();
    const std::array<Motion, handCount> motions = motionsOf(all);
    const double middle = threadSeconds();
    values = valuesOf(motions, isMotion);
    const double end = threadSeconds();
    filtering = middle - start;
    whole = end - start;
    const double before = threadSeconds();
    benchmark::DoNotOptimize(valuesOf(motionsOf(all), [](const auto& d) { return d.name == "path-length"; }));
    path = threadSeconds() - before;
    const double first = threadSeconds();
    benchmark::DoNotOptimize(plainPath(all));
    plain = threadSeconds() - first;
    bench.SetIterationTime(whole);
  }
  bench.counters["values"] = static_cast<double>(values);
  bench.counters["filtering_ms"] = 1e3 * filtering;
  bench.counters["path_ms"] = 1e3 * path;
  bench.counters["plain_path_ms"] = 1e3 * plain;
  bench.counters["vs_path"] = whole / path;
  figures().add("checkpoints.motion_10min_ms", 1e3 * whole);
  figures().add("checkpoints.motion_vs_path", whole / path);
}

}  // namespace
}  // namespace calot::bench::checkpoints_bench

void calot::bench::registerCheckpoints() {
  using namespace checkpoints_bench;
  repeated(benchmark::RegisterBenchmark("checkpoints/motion/10min", motion), 9);
}
