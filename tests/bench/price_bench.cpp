// SPDX-License-Identifier: GPL-3.0-or-later
// What the determinism contract costs: the boxes' steps against those of the same sources built without its flags, for
// this very machine (-O3 -march=native -ffast-math), each alone in a process, in turn. And the memory that a box takes.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/hanging_box.h"
#include "tests/bench/repeated.h"

namespace calot::bench {

namespace {

struct BoxRun {
  double seconds = 0.0;  ///< a step
  double iterations = 0.0;
  double memory = 0.0;  ///< largest of the process (MB)
};

/// Programs lie beside this one.
std::filesystem::path programBeside(const char* name) {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
}

BoxRun runBox(const std::filesystem::path& program, int tetrahedra, int rounds) {
  const std::string command = fmt::format("'{}' {} {}", program.string(), tetrahedra, rounds);
  FILE* out = popen(command.c_str(), "r");
  if (out == nullptr) throw std::runtime_error(command + ": cannot be run");
  std::string text;
  std::array<char, 256> part{};
  while (std::fgets(part.data(), part.size(), out) != nullptr) text += part.data();
  if (pclose(out) != 0) throw std::runtime_error(command + ": failed");
  const nlohmann::json json = nlohmann::json::parse(text);
  return {json.at("seconds"), json.at("iterations"), json.at("memory_mb")};
}

void price(benchmark::State& bench, const BoxSize& size) {
  const std::filesystem::path unbound = programBeside("calot-box-unbound");
  if (!std::filesystem::exists(unbound)) {
    bench.SkipWithError("calot-box-unbound is not there: ninja calot-box-unbound");
    return;
  }
  BoxRun own;
  BoxRun peer;
  for (auto _ : bench) {
    own.seconds = peer.seconds = 1e300;
    for (int i = 0; i < 3; ++i) {
      const BoxRun a = runBox(programBeside("calot-box"), size.tetrahedra, 2);
      const BoxRun b = runBox(unbound, size.tetrahedra, 2);
      if (a.seconds < own.seconds) own = a;
      if (b.seconds < peer.seconds) peer = b;
    }
    bench.SetIterationTime(own.seconds);
  }
  auto& counters = bench.counters;
  counters["unbound_ms"] = 1e3 * peer.seconds;
  counters["over_unbound"] = own.seconds / peer.seconds;
  counters["iterations"] = own.iterations;
  counters["unbound_iterations"] = peer.iterations;
  figures().add("price." + std::to_string(size.tetrahedra) + ".over_unbound", own.seconds / peer.seconds);
}

void memory(benchmark::State& bench, const BoxSize& size) {
  BoxRun own;
  for (auto _ : bench) {
    own = runBox(programBeside("calot-box"), size.tetrahedra, 1);
    bench.SetIterationTime(own.seconds);
  }
  bench.counters["memory_mb"] = own.memory;
  bench.counters["bytes_a_tetrahedron"] = 1e6 * own.memory / size.tetrahedra;
  figures().addLargest("boxes." + std::to_string(size.tetrahedra) + ".memory_mb", own.memory);
}

}  // namespace

void registerPrice() {
  for (const BoxSize& size : boxSizes) {
    const std::string name = std::to_string(size.tetrahedra);
    repeated(benchmark::RegisterBenchmark(("price/" + name).c_str(), price, size), size.tetrahedra > 20000 ? 1 : 3);
    repeated(benchmark::RegisterBenchmark(("memory/" + name).c_str(), memory, size), 1);
  }
}

}  // namespace calot::bench
