// SPDX-License-Identifier: GPL-3.0-or-later
// Whole steps of every scene, ticks included, as a performer works in it: its first 20 s, and the whole operation from
// the first touch to the free gallbladder. The peer is touch-liver in the same run: what fat, vessels and connective
// tissue cost beside it.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "recorder/engine/session.h"
#include "recorder/formats/scene_file.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/numbers.h"
#include "tests/bench/performed.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench {

namespace {

constexpr std::uint64_t seed = 1;
constexpr double measuredSeconds = 20.0;  // of attempt time: in the operation, fat is carved all the while
constexpr double wholeSeconds = 600.0;    // at most
const char* const scenes[] = {"touch-liver", "dissect-bed", "clip-and-cut", "carve-fat", "cholecystectomy"};

/// A scene and what a performer did in it: the same samples for every repetition.
struct Work {
  std::unique_ptr<const Model> model;
  Motion motion;
};

Work workIn(const std::string& scene, double attemptSeconds) {
  return {built(recorder::loadScene(std::string(CALOT_ASSETS) + "/scenes/" + scene + ".json").description),
          performed(scene, attemptSeconds)};
}

/// CPU time of each step with its ticks (s).
std::vector<double> run(const Work& work) {
  SerialExecutor executor;
  recorder::Session session(*work.model, seed, executor);
  std::vector<recorder::TickOutcome> ticks(work.model->scene().ticksPerStep);
  std::vector<double> seconds;
  for (const std::vector<TickSamples>& samples : work.motion.step) {
    const double begin = threadSeconds();
    for (std::size_t i = 0; i < samples.size(); ++i) ticks[i] = session.tick(samples[i]);
    session.step(samples, ticks, 0.0F);
    seconds.push_back(threadSeconds() - begin);
  }
  return seconds;
}

double meanOf(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

void sceneStep(benchmark::State& bench, const std::string& scene, double attemptSeconds, const std::string& figure) {
  static const Work peer = workIn(scenes[0], measuredSeconds);
  const Work work = workIn(scene, attemptSeconds);
  std::vector<double> seconds;
  for (auto _ : bench) {
    seconds = run(work);
    bench.SetIterationTime(meanOf(seconds));
  }
  const double mean = meanOf(seconds);
  auto& counters = bench.counters;
  counters["p50_ms"] = 1e3 * quantile(seconds, 0.5);
  counters["p99_ms"] = 1e3 * quantile(seconds, 0.99);
  counters["steps"] = static_cast<double>(seconds.size());
  counters["real_time"] = work.model->stepSeconds() / mean;
  counters["vs_touch_liver"] = mean / meanOf(run(peer));
  figures().add(figure, 1e3 * mean);
}

}  // namespace

void registerScenes() {
  for (const std::string scene : scenes) {
    repeated(benchmark::RegisterBenchmark(("scene/step/" + scene).c_str(), sceneStep, scene, measuredSeconds,
                                          "scene." + scene + ".step_ms"),
             3);
  }
  repeated(benchmark::RegisterBenchmark("scene/operation/cholecystectomy", sceneStep, "cholecystectomy", wholeSeconds,
                                        "scene.operation.step_ms"),
           2);
}

}  // namespace calot::bench
