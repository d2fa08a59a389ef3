// SPDX-License-Identifier: GPL-3.0-or-later
// The solver's kernels against what this machine can do (Williams, Waterman and Patterson 2009, "Roofline"). The limits
// are measured in the same run, on one thread: how fast a copy and a triad (McCalpin 1995, "STREAM") go over as many
// bytes as the kernel touches, and how many operations a second come out of registers. The kernels' bytes and
// operations are counted from their structure: each array once a pass, padding included.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/math/vectors.h"
#include "sim/solid/conjugate_gradient.h"
#include "sim/solid/solid_model.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/hanging_box.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench::roofline_bench {

namespace {

CALOT_LANE_KERNEL void copy(const float* a, float* b, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) b[i] = a[i];
}

CALOT_LANE_KERNEL void triad(const float* a, const float* b, float scale, float* c, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) c[i] = a[i] + scale * b[i];
}

/// Ten chains of eight lanes in registers, a product and a sum each a round.
CALOT_LANE_KERNEL void multiplyAndAdd(float* out, std::size_t rounds) {
  constexpr std::size_t chains = 10;
  EightFloats chain[chains];
  for (std::size_t c = 0; c < chains; ++c) readVector(out + c * laneCount, chain[c]);
  for (std::size_t n = 0; n < rounds; ++n) {
    for (std::size_t c = 0; c < chains; ++c) chain[c] = chain[c] * 0.999F + 0.001F;
  }
  for (std::size_t c = 0; c < chains; ++c) writeVector(chain[c], out + c * laneCount);
}

/// Least time of a call, of so many tries of at least 20 ms (s).
template <class Call>
double minTime(const Call& call) {
  double least = 1e300;
  std::size_t calls = 1;
  for (int tried = 0; tried < 5;) {
    const double begin = threadSeconds();
    for (std::size_t i = 0; i < calls; ++i) call();
    const double spent = threadSeconds() - begin;
    if (spent < 0.02) {
      calls *= 2;
      continue;
    }
    least = std::min(least, spent / static_cast<double>(calls));
    ++tried;
  }
  return least;
}

struct Limits {
  double copy = 0.0, triad = 0.0;  ///< bytes a second
  double operations = 0.0;         ///< float, a second
};

/// @param bytes that the arrays take together
Limits limitsAt(double bytes) {
  Limits limits;
  const auto count = static_cast<std::size_t>(bytes / (3.0 * sizeof(float)));
  std::vector<float> a(count, 1.0F);
  std::vector<float> b(count, 2.0F);
  std::vector<float> c(count, 3.0F);
  const auto size = static_cast<double>(count * sizeof(float));
  limits.copy = 2.0 * size / minTime([&] { copy(a.data(), c.data(), count); });
  limits.triad = 3.0 * size / minTime([&] { triad(a.data(), b.data(), 0.5F, c.data(), count); });
  benchmark::DoNotOptimize(c.data());
  std::array<float, 10 * laneCount> chain{};
  constexpr std::size_t rounds = 10000;
  limits.operations =
      static_cast<double>(2 * chain.size() * rounds) / minTime([&] { multiplyAndAdd(chain.data(), rounds); });
  benchmark::DoNotOptimize(chain.data());
  return limits;
}

struct Work {
  double bytes = 0.0;      ///< moved to or from memory of any level
  double footprint = 0.0;  ///< different ones
  double operations = 0.0;
};

/// An iteration of ConjugateGradient: a sweep back, one forth, an update.
Work iterationOf(const BlockMatrix& matrix) {
  constexpr double number = sizeof(float);
  const auto slices = static_cast<double>(matrix.slices());
  double columns = 0.0;  // block columns left of the diagonal
  for (std::size_t s = 0; s < matrix.slices(); ++s) columns += static_cast<double>(matrix.lower(s).width);
  const double block = 9.0 * laneCount * number;
  const double lower = columns * (block + laneCount * sizeof(std::int32_t));
  const double lanes = slices * 3.0 * laneCount * number;                  // a vector by lanes
  const double rows = slices * rowStride * laneCount * number;             // and by rows
  const double back = lower + slices * block + 4.0 * lanes + 3.0 * rows;   // z, p twice, t; u: emptied, read, added to
  const double forth = lower + slices * block + 3.0 * lanes + 3.0 * rows;  // s, p, t; u, the copy of s written and read
  const double update = slices * block + 7.0 * lanes;                      // t, s, x twice, r twice, z
  Work work;
  work.bytes = back + forth + update;
  work.footprint = lower + 2.0 * slices * block + 6.0 * lanes + 2.0 * rows;
  work.operations = laneCount * (2.0 * 18.0 * columns + (3.0 * 15.0 + 45.0) * slices);
  return work;
}

/// The pass over the elements: rotations and forces.
Work elementPassOf(const SolidModel& model) {
  Work work;
  const auto groups = static_cast<double>(model.groups());
  const auto nodes = static_cast<double>(model.nodes());
  work.bytes = groups * (sizeof(ElementGroup) + 2.0 * sizeof(RotationGroup) + sizeof(ElementResult)) +
               groups * laneCount * 4.0 * 2.0 * sizeof(Vec3);
  work.footprint =
      groups * (sizeof(ElementGroup) + sizeof(RotationGroup) + sizeof(ElementResult)) + 2.0 * nodes * sizeof(Vec3);
  return work;
}

void put(benchmark::State& bench, const std::string& size, const std::string& kernel, const Work& work,
         double seconds) {
  const Limits limits = limitsAt(work.footprint);
  auto& counters = bench.counters;
  const double rate = work.bytes / seconds;
  counters[kernel + "_gb_per_s"] = 1e-9 * rate;
  counters[kernel + "_mb"] = 1e-6 * work.footprint;
  counters[kernel + "_copy_gb_per_s"] = 1e-9 * limits.copy;
  counters[kernel + "_triad_gb_per_s"] = 1e-9 * limits.triad;
  counters[kernel + "_of_triad"] = rate / limits.triad;
  figures().add("roofline." + size + "." + kernel + ".gb_per_s", 1e-9 * rate);
  figures().add("roofline." + size + "." + kernel + ".of_triad", rate / limits.triad);
  if (work.operations == 0.0) return;
  counters[kernel + "_gflop_per_s"] = 1e-9 * work.operations / seconds;
  counters[kernel + "_of_peak"] = work.operations / seconds / limits.operations;
  counters["peak_gflop_per_s"] = 1e-9 * limits.operations;
  figures().add("roofline." + size + "." + kernel + ".of_peak", work.operations / seconds / limits.operations);
}

void roofline(benchmark::State& bench, const BoxSize& size) {
  const HangingBody body = hangingBox(size, HangingBox::soft);
  const SolidModel model = modelOf(body);
  SolidState state = restState(model);
  SerialExecutor executor;
  StiffnessAssembly assembly;
  std::vector<float> values;
  const StiffnessAssembly::Scale scale{1.0, body.step * body.step};
  const auto assemble = [&] {
    assembly.assemble(model, model.system(), state.rotation, {}, model.mass(), scale, executor, values);
  };
  assemble();
  const BlockMatrix& matrix = model.system().matrix();
  ConjugateGradient cg;
  cg.precompute(matrix, values);
  std::vector<float> b(matrix.vectorSize(), 0.0F);
  std::vector<float> x(matrix.vectorSize());
  for (const int node : model.freeNodes())
    b[model.system().offsetOf(static_cast<std::size_t>(node)) + laneCount] = -1.0F;
  std::vector<ElementResult> result(model.groups());
  const std::string name = std::to_string(size.tetrahedra);
  for (auto _ : bench) {
    // No tolerance: as many iterations as asked for, and one more sweep and update to begin with.
    constexpr std::uint32_t iterations = 20;
    const double iteration = minTime([&] { cg.solve(matrix, values, b, x, {0.0, iterations}); }) / (iterations + 0.5);
    put(bench, name, "iteration", iterationOf(matrix), iteration);
    const double elements = minTime([&] {
      model.elements().evaluate(state.position, state.velocity, body.step, model.material().lame, 2, state.rotation,
                                result, executor);
    });
    put(bench, name, "elements", elementPassOf(model), elements);
    bench.counters["assembly_ns_a_tetrahedron"] = 1e9 * minTime(assemble) / size.tetrahedra;
    bench.counters["elements_ns_a_tetrahedron"] = 1e9 * elements / size.tetrahedra;
    bench.counters["iteration_ns_a_tetrahedron"] = 1e9 * iteration / size.tetrahedra;
    bench.SetIterationTime(iteration);
  }
}

}  // namespace
}  // namespace calot::bench::roofline_bench

void calot::bench::registerRoofline() {
  using namespace roofline_bench;

  for (const BoxSize& size : boxSizes) {
    repeated(benchmark::RegisterBenchmark(("roofline/" + std::to_string(size.tetrahedra)).c_str(), roofline, size), 3);
  }
}
