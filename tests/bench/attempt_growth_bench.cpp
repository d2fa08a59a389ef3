// SPDX-License-Identifier: GPL-3.0-or-later
// Does a long attempt cost more at its end than at its beginning? Touch-liver with coarse organs, recorded over up to
// 45 minutes of attempt time while two graspers press, slide and rest again and again; late against early.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recorder/engine/session.h"
#include "recorder/formats/scene_file.h"
#include "recorder/loop.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "sim/math/random.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/folder.h"
#include "tests/bench/numbers.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"
#include "tests/bench/touch_motion.h"

namespace calot::bench {

namespace {

constexpr std::uint64_t seed = 1;
constexpr double minute = 60.0;
constexpr std::array<double, 4> lengths{5.0, 10.0, 20.0, 45.0};  // minutes

/// Touch-liver with 300 tetrahedra in its liver; its organs sleep where nothing touches them.
recorder::LoadedScene coarseScene() {
  std::vector<recorder::Asset> files = recorder::loadScene(CALOT_ASSETS "/scenes/touch-liver.json").assets;
  std::string text(reinterpret_cast<const char*>(files[0].bytes.data()), files[0].bytes.size());
  text.replace(text.find("1489"), 4, "300");
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  files[0].bytes.assign(bytes, bytes + text.size());
  return recorder::sceneFromAssets(std::move(files));
}

/// Memory of this process that is in use now (MB).
double residentMemory() {
  std::ifstream in("/proc/self/statm");
  double pages = 0.0;
  in >> pages >> pages;
  return 1e-6 * pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// One round: eight seconds of pressing and sliding, then seven at rest, with hands on their way home and back.
std::vector<std::vector<TickSamples>> roundOf(const SceneDescription& scene) {
  constexpr std::size_t pressed = 800, away = 200, resting = 500;
  const Motion motion = pressAndSlide(scene, pressed);
  std::vector<std::vector<TickSamples>> steps = motion.step;
  const TickSamples last = steps.back().back();
  const TickSamples first = steps.front().front();
  for (std::size_t n = 0; n < away + resting; ++n) {
    std::vector<TickSamples> step(scene.ticksPerStep, last);
    for (std::size_t i = 0; i < step.size(); ++i) {
      const double s = std::min(1.0, (static_cast<double>(n) + static_cast<double>(i + 1) / 10.0) / away);
      for (std::size_t h = 0; h < handCount; ++h) {
        step[i].hand[h].position = last.hand[h].position + s * (first.hand[h].position - last.hand[h].position);
      }
      step[i] = roundedToGrid(step[i]);
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

/// What the recording cost, minute by minute.
struct Course {
  std::vector<double> cpu;     ///< of the loop's thread for a step, mean over the minute (s)
  std::vector<double> memory;  ///< of the process at the minute's end (MB)
};

Course record(const Model& model, const recorder::LoadedScene& scene, double minutes, const std::filesystem::path& to) {
  SerialExecutor executor;
  recorder::Session session(model, seed, executor);
  recorder::AttemptSettings settings;
  settings.seed = seed;
  recorder::Provenance by;
  by.profile = "skilled";
  recorder::RecordingWriter writer(to, recorder::makeHeader(model, scene.assets, by, settings),
                                   recorder::WriterOptions{true});
  session.join(writer);
  const std::vector<std::vector<TickSamples>> round = roundOf(model.scene());
  std::vector<recorder::TickOutcome> ticks(model.scene().ticksPerStep);
  const auto perMinute = static_cast<std::size_t>(minute / model.stepSeconds() + 0.5);
  Course course;
  std::size_t at = 0;
  for (int m = 0; m < static_cast<int>(minutes + 0.5); ++m) {
    const double begin = threadSeconds();
    for (std::size_t n = 0; n < perMinute; ++n, ++at) {
      const std::vector<TickSamples>& samples = round[at % round.size()];
      for (std::size_t i = 0; i < samples.size(); ++i) ticks[i] = session.tick(samples[i]);
      session.step(samples, ticks, 0.0F);
    }
    course.cpu.push_back((threadSeconds() - begin) / static_cast<double>(perMinute));
    course.memory.push_back(residentMemory());
  }
  session.end(recorder::Outcome::completed);
  writer.finish();
  return course;
}

double mean(const std::vector<double>& values, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t i = from; i < to; ++i) sum += values[i] / static_cast<double>(to - from);
  return sum;
}

/// Median time of 20 seeks to random steps between two (s).
double seekTime(recorder::Seeker& seeker, std::uint64_t from, std::uint64_t to) {
  Random random(17);
  std::vector<double> seconds;
  for (int i = 0; i < 20; ++i) {
    const auto step = from + static_cast<std::uint64_t>(random.uniform() * static_cast<double>(to - from));
    const double begin = threadSeconds();
    seeker.seek(step);
    seconds.push_back(threadSeconds() - begin);
  }
  return quantile(seconds, 0.5);
}

void attemptGrowth(benchmark::State& bench) {
  static const Folder folder("growth");
  const recorder::LoadedScene scene = coarseScene();
  const std::unique_ptr<const Model> model = built(scene.description);
  auto& counters = bench.counters;
  for (auto _ : bench) {
    std::vector<double> cost;   // a step, by length
    std::vector<double> bytes;  // a minute
    double spent = 0.0;
    for (const double minutes : lengths) {
      const std::filesystem::path file = folder / "long.h5";
      const Course course = record(*model, scene, minutes, file);
      const std::size_t all = course.cpu.size();
      const double whole = mean(course.cpu, 0, all);
      spent = whole;
      cost.push_back(whole);
      bytes.push_back(static_cast<double>(std::filesystem::file_size(file)) / minutes);
      const std::string at = "_" + std::to_string(static_cast<int>(minutes)) + "min";
      counters["step_us" + at] = 1e6 * whole;
      counters["mb_a_minute" + at] = 1e-6 * bytes.back();
      if (minutes == lengths.back()) {
        // The first minute, in which compliances are worked out, is no part of the early ones.
        const double early = mean(course.cpu, 1, 6);
        const double late = mean(course.cpu, all - 5, all);
        const double grown = course.memory.back() - course.memory[4];
        recorder::Recording recording(file);
        const double opened = threadSeconds();
        const std::uint64_t steps = recording.stepCount();
        recorder::Seeker seeker(recording);
        seeker.seek(steps / 2);  // what is worked out once is not the later ones'
        const double seekEarly = seekTime(seeker, 0, steps / 9);
        const double seekLate = seekTime(seeker, steps - steps / 9, steps);
        counters["late_over_early"] = late / early;
        counters["memory_grown_mb"] = grown;
        counters["keyframes"] = static_cast<double>(recording.keyframeSteps().size());
        counters["seek_early_ms"] = 1e3 * seekEarly;
        counters["seek_late_over_early"] = seekLate / seekEarly;
        counters["seeks_s"] = threadSeconds() - opened;
        figures().add("growth.attempt.late_over_early", late / early);
        figures().add("growth.attempt.memory_grown_mb", grown);
        figures().add("growth.attempt.mb_a_minute", 1e-6 * bytes.back());
        figures().add("growth.attempt.seek_late_over_early", seekLate / seekEarly);
      }
      std::filesystem::remove(file);
    }
    counters["exponent_step"] = growthExponent(lengths, cost);
    counters["exponent_bytes_a_minute"] = growthExponent(lengths, bytes);
    figures().add("growth.attempt.exponent", growthExponent(lengths, cost));
    bench.SetIterationTime(spent);
  }
}

}  // namespace

void registerAttemptGrowth() { repeated(benchmark::RegisterBenchmark("growth/attempt", attemptGrowth), 1); }

}  // namespace calot::bench
