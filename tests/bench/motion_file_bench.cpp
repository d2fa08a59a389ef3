// SPDX-License-Identifier: GPL-3.0-or-later
// A table of motion read by its map, against std::from_chars over the same bytes.
#include <benchmark/benchmark.h>

#include <fmt/format.h>
#include <charconv>
#include <cmath>
#include <span>
#include <string>

#include "recorder/sources/column_map.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench::motion_file_bench {
namespace {

constexpr std::size_t rows = 200000;

/// Both hands with orientations, every column wanted: what costs most.
std::string tableOf() {
  std::string text = "t,lx,ly,lz,lw,li,lj,lk,rx,ry,rz,rw,ri,rj,rk\n";
  for (std::size_t i = 0; i < rows; ++i) {
    const double t = 0.01 * static_cast<double>(i);
    text += fmt::format("{:.6f}", t);
    for (const double phase : {0.0, 1.0}) {
      const double angle = 0.4 * std::sin(0.8 * t + phase);
      text += fmt::format(",{:.6f},{:.6f},{:.6f},{:.9f},{:.9f},0,0", 40.0 * std::sin(1.9 * t + phase),
                          30.0 * std::sin(2.7 * t), 100.0 + 20.0 * std::sin(1.1 * t), std::cos(angle), std::sin(angle));
    }
    text += '\n';
  }
  return text;
}

recorder::ColumnMap mapOf() {
  constexpr std::string_view json = R"({"format": "calot-columns", "formatVersion": 1, "frame": "world", "length": "mm",
    "time": {"column": "t", "unit": "s"},
    "left": {"position": ["lx", "ly", "lz"], "quaternion": ["lw", "li", "lj", "lk"]},
    "right": {"position": ["rx", "ry", "rz"], "quaternion": ["rw", "ri", "rj", "rk"]}})";
  return recorder::parseColumnMap(std::as_bytes(std::span(json)), "map.json");
}

double numbersOf(const std::string& text) {
  double sum = 0.0;
  const char* at = text.data() + text.find('\n');
  for (const char* end = text.data() + text.size(); at < end; ++at) {
    double value = 0.0;
    at = std::from_chars(at + 1, end, value).ptr;
    sum += value;
  }
  return sum;
}

void table(benchmark::State& bench) {
  const std::string text = tableOf();
  const recorder::ColumnMap map = mapOf();
  double own = 0.0;
  for (auto _ : bench) {
    const double begin = threadSeconds();
    benchmark::DoNotOptimize(recorder::parseCsvMotion(std::as_bytes(std::span(text)), "m.csv", map));
    own = threadSeconds() - begin;
    bench.SetIterationTime(own);
  }
  const double begin = threadSeconds();
  benchmark::DoNotOptimize(numbersOf(text));
  const double bare = threadSeconds() - begin;
  bench.counters["mb_per_s"] = 1e-6 * static_cast<double>(text.size()) / own;
  bench.counters["over_from_chars"] = own / bare;
  figures().add("motion_file.over_from_chars", own / bare);
}

}  // namespace
}  // namespace calot::bench::motion_file_bench

void calot::bench::registerMotionFile() {
  repeated(benchmark::RegisterBenchmark("motion/file", motion_file_bench::table), 5);
}
