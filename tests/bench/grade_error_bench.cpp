// SPDX-License-Identifier: GPL-3.0-or-later
// Time against error at the level of the grade: how far each figure of the paper's Table 2 and each figure of force is
// from its extrapolated limit, over meshes, steps and tolerances of the solver, beside what they cost. One performer's
// samples, open loop.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "analytics/uncertainty/uncertainty.h"
#include "recorder/formats/scene_file.h"
#include "recorder/loop.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/performed.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench {

namespace {

struct Division {
  double elements = 1.0;
  std::uint32_t ticksPerStep = 10;
  double tolerance = 1.0;  ///< times the scene's

  [[nodiscard]] std::string name() const { return fmt::format("m{}.h{}.t{}", elements, ticksPerStep, tolerance); }
};

// The scenes' default among them; of the finest three the limit is extrapolated.
constexpr Division finest{4.0, 5, 1.0}, longerStep{4.0, 10, 1.0}, coarserMesh{2.0, 5, 1.0};
constexpr std::array divisions{Division{0.5, 20, 1.0},
                               Division{0.5, 10, 1.0},
                               Division{1.0, 20, 1.0},
                               Division{1.0, 10, 1.0},
                               Division{1.0, 5, 1.0},
                               Division{1.0, 10, 10.0},
                               Division{1.0, 10, 0.1},
                               Division{2.0, 20, 1.0},
                               Division{2.0, 10, 1.0},
                               coarserMesh,
                               longerStep,
                               finest};

struct Graded {
  std::map<std::string, double> value;
  double milliseconds = 0.0;  ///< CPU time for 10 ms of the attempt
};

bool isAsked(const std::string& name) {
  static const std::array<std::string, 8> asked{
      "fat-remaining",   "cystic-contact-time", "connective-remaining", "organ-burned",
      "connective-torn", "contact-time-union",  "force-mean",           "force-p99"};
  return std::find(asked.begin(), asked.end(), name) != asked.end();
}

SceneDescription dividedScene(const SceneDescription& scene, const Division& division) {
  SceneDescription divided = analytics::redivided(scene, division.ticksPerStep, division.elements);
  divided.solver.tolerance *= division.tolerance;
  divided.solver.speedTolerance *= division.tolerance;
  divided.solver.responseTolerance *= division.tolerance;
  divided.solver.responseSpeedTolerance *= division.tolerance;
  divided.solver.gapTolerance *= division.tolerance;
  return divided;
}

Graded graded(const SceneDescription& scene, const Division& division, const recorder::AttemptInputs& inputs) {
  const Model::Built built = Model::build(dividedScene(scene, division));
  if (!built.model) throw std::runtime_error(built.error);
  const recorder::AttemptHeader header = recorder::makeHeader(*built.model, {}, {}, {});
  const double begin = threadSeconds();
  const analytics::OpenLoopRun run = analytics::runIn(*built.model, header, inputs);
  Graded out;
  out.milliseconds = 1e3 * (threadSeconds() - begin) * 10.0 / static_cast<double>(inputs.samples.size());
  for (const analytics::CheckpointValue& v : run.values) {
    if (v.value && isAsked(v.name)) out.value[v.subject.empty() ? v.name : v.name + " " + v.subject] = *v.value;
  }
  return out;
}

/// What is left to the limit after the last refinement. @param last its change @param before that of the one before
/// @param ratio of the lengths
double remainder(double last, double before, double ratio) {
  const bool converges = last * before > 0.0 && std::abs(last) < std::abs(before);
  return converges ? last / (ratio - 1.0) : 0.0;
}

void grade(benchmark::State& bench, const std::string& name, double seconds) {
  const SceneDescription scene = recorder::loadScene(std::string(CALOT_ASSETS "/scenes/") + name + ".json").description;
  recorder::AttemptInputs inputs;
  for (const std::vector<TickSamples>& step : performed(name, seconds).step)
    inputs.samples.insert(inputs.samples.end(), step.begin(), step.end());
  inputs.samples.resize(inputs.samples.size() - inputs.samples.size() % 20);  // whole steps of all divisions
  inputs.outcome = recorder::Outcome::completed;
  inputs.seed = 1;
  std::map<std::string, Graded> runs;
  for (auto _ : bench) {
    const double begin = threadSeconds();
    for (const Division& division : divisions) runs[division.name()] = graded(scene, division, inputs);
    bench.SetIterationTime(threadSeconds() - begin);
  }
  const Graded& best = runs.at(finest.name());
  for (const auto& [figure, value] : best.value) {
    const auto of = [&](const Division& division) {
      const auto& values = runs.at(division.name()).value;
      const auto found = values.find(figure);
      return found == values.end() ? std::nan("") : found->second;
    };
    // First order in step and size, where the last halving of the step and doubling of the elements changed less than
    // the one before: else the finest run is the best there is.
    const double step = remainder(value - of(longerStep), of({2.0, 10, 1.0}) - of({2.0, 20, 1.0}), 2.0);
    const double mesh = remainder(value - of(coarserMesh), of(coarserMesh) - of({1.0, 5, 1.0}), std::cbrt(2.0));
    const double limit = value + step + mesh;
    if (!std::isfinite(limit) || !(std::abs(limit) > 0.0)) continue;
    for (const Division& division : divisions) {
      const double error = std::abs(of(division) - limit) / std::abs(limit);
      if (std::isfinite(error))
        figures().add(fmt::format("grade.{}.{}.error.{}", name, division.name(), figure), error);
    }
  }
  for (const Division& division : divisions) {
    const double cost = runs.at(division.name()).milliseconds;
    figures().add(fmt::format("grade.{}.{}.ms", name, division.name()), cost);
    bench.counters[division.name()] = cost;
  }
}

}  // namespace

void registerGradeError() {
  const std::array<std::pair<const char*, double>, 3> scenes{
      {{"dissect-bed", 20.0}, {"carve-fat", 15.0}, {"clip-and-cut", 20.0}}};
  for (const auto& [scene, seconds] : scenes) {
    repeated(benchmark::RegisterBenchmark((std::string("grade/") + scene).c_str(), grade, scene, seconds), 1);
  }
}

}  // namespace calot::bench
