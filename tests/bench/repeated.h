// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

namespace calot::bench {

/// A benchmark that gives its own time (SetIterationTime): mean, median, spread and least of so many repetitions of one
/// iteration.
inline benchmark::internal::Benchmark* repeated(benchmark::internal::Benchmark* bench, int repetitions) {
  return bench->Repetitions(repetitions)
      ->DisplayAggregatesOnly(true)
      ->ComputeStatistics("min", [](const std::vector<double>& v) { return *std::min_element(v.begin(), v.end()); })
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMicrosecond);
}

}  // namespace calot::bench
