// SPDX-License-Identifier: GPL-3.0-or-later
// What recording costs the thread of the loop; how fast a recording is verified; how long a seek takes. Peers: the same
// steps without a writer; the time that the attempt took; a step.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "recorder/engine/session.h"
#include "recorder/formats/scene_file.h"
#include "recorder/loop.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "recorder/verification.h"
#include "sim/math/random.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/folder.h"
#include "tests/bench/numbers.h"
#include "tests/bench/performed.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench::recording_bench {

namespace {

constexpr std::uint64_t seed = 1;
const std::string assets = CALOT_ASSETS;

double processSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Work {
  recorder::LoadedScene scene;
  std::unique_ptr<const Model> model;
  Motion motion;
};

Work workIn(const std::string& scene, double seconds) {
  Work work;
  work.scene = recorder::loadScene(assets + "/scenes/" + scene + ".json");
  work.model = built(work.scene.description);
  work.motion = performed(scene, seconds);
  return work;
}

/// CPU time of the loop's thread for all steps (s). @param to where they are recorded, or empty
double run(const Work& work, const std::filesystem::path& to, const char* purpose = "training") {
  SerialExecutor executor;
  recorder::Session session(*work.model, seed, executor);
  std::unique_ptr<recorder::RecordingWriter> writer;
  if (!to.empty()) {
    recorder::AttemptSettings settings;
    settings.seed = seed;
    settings.purpose = purpose;
    recorder::Provenance by;
    by.profile = "skilled";
    writer = std::make_unique<recorder::RecordingWriter>(
        to, recorder::makeHeader(*work.model, work.scene.assets, by, settings), recorder::WriterOptions{true});
    session.join(*writer);
  }
  std::vector<recorder::TickOutcome> ticks(work.model->scene().ticksPerStep);
  const double begin = threadSeconds();
  for (const std::vector<TickSamples>& samples : work.motion.step) {
    for (std::size_t i = 0; i < samples.size(); ++i) ticks[i] = session.tick(samples[i]);
    session.step(samples, ticks, 0.0F);
  }
  const double spent = threadSeconds() - begin;
  session.end(recorder::Outcome::completed);
  if (writer) writer->finish();
  return spent;
}

void overhead(benchmark::State& bench, const std::string& scene) {
  static const Folder folder("overhead");
  const Work work = workIn(scene, 20.0);
  const auto steps = static_cast<double>(work.motion.step.size());
  double without = 0.0;
  double with = 0.0;
  for (auto _ : bench) {
    // In turn, so that neither has the machine to itself; the least of each is what it costs.
    without = with = 1e9;
    for (int i = 0; i < 4; ++i) {
      without = std::min(without, run(work, {}));
      with = std::min(with, run(work, folder / "overhead.h5"));
    }
    bench.SetIterationTime((with - without) / steps);
  }
  auto& counters = bench.counters;
  counters["step_ms"] = 1e3 * without / steps;
  counters["percent_of_loop"] = 100.0 * (with - without) / without;
  counters["percent_of_period"] = 100.0 * (with - without) / steps / work.model->stepSeconds();
  if (scene != "touch-liver") return;  // the shortest step, of which recording is the largest share
  figures().add("record.overhead_percent", 100.0 * (with - without) / without);
  figures().add("record.period_percent", 100.0 * (with - without) / steps / work.model->stepSeconds());
}

void replay(benchmark::State& bench) {
  static const Folder folder("replay");
  const std::filesystem::path golden = folder / "golden.h5";
  run(workIn("cholecystectomy", 600.0), golden, "golden");
  recorder::ReplayReport report;
  double spent = 0.0;
  for (auto _ : bench) {
    const double begin = processSeconds();
    report = recorder::replayRecording(golden, {});
    spent = processSeconds() - begin;
    bench.SetIterationTime(spent);
  }
  if (report.verdict != recorder::ReplayVerdict::exact) throw std::runtime_error("does not replay: " + report.error);
  auto& counters = bench.counters;
  counters["attempt_s"] = report.seconds;
  counters["x_realtime"] = report.seconds / spent;
  counters["ms_a_step"] = 1e3 * spent / static_cast<double>(report.steps);
  figures().add("replay.cholecystectomy.x_realtime", report.seconds / spent);
}

/// When the last of so many workers is done that take segments in their order (s).
double criticalPath(const std::vector<double>& seconds, std::size_t workers) {
  std::vector<double> busy(workers, 0.0);
  for (const double s : seconds) *std::min_element(busy.begin(), busy.end()) += s;
  return *std::max_element(busy.begin(), busy.end());
}

/// A whole operation, verified on one thread and on two (wall time), and what as many as segments would allow: each
/// segment is timed alone.
void segments(benchmark::State& bench) {
  static const Folder folder("segments");
  const std::filesystem::path file = folder / "segments.h5";
  run(workIn("cholecystectomy", 600.0), file);
  const recorder::Recording recording(file);
  const std::vector<recorder::Segment> all = recorder::segmentsOf(recording);
  const recorder::EngineChoice inside(recording, {});
  std::vector<double> alone;
  double two = 0.0;
  for (auto _ : bench) {
    const auto timed = [&](const std::vector<recorder::Segment>& some, unsigned threads) {
      const auto begin = std::chrono::steady_clock::now();
      const recorder::SegmentsVerdict verdict = recorder::verifySegments(file, inside, some, threads);
      if (verdict.divergence) throw std::runtime_error("diverged at step " + std::to_string(verdict.divergence->step));
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    alone.clear();
    for (const recorder::Segment& segment : all) alone.push_back(timed({segment}, 1));
    two = timed(all, 2);
    bench.SetIterationTime(two);
  }
  const double sum = criticalPath(alone, 1);
  auto& counters = bench.counters;
  counters["segments"] = static_cast<double>(all.size());
  counters["longest_ms"] = 1e3 * *std::max_element(alone.begin(), alone.end());
  counters["file_mb"] = 1e-6 * static_cast<double>(std::filesystem::file_size(file));
  const auto add = [&](const std::string& name, double value) {
    counters[name] = value;
    figures().add("replay.cholecystectomy." + name, value);
  };
  add("x_realtime_2", recording.seconds() / two);
  add("speedup_2", sum / two);
  for (const std::size_t workers : {8U, 32U}) {
    add("path_" + std::to_string(workers), sum / criticalPath(alone, workers));
  }
  figures().add("record.operation_mb", 1e-6 * static_cast<double>(std::filesystem::file_size(file)));
}

void seek(benchmark::State& bench) {
  static const Folder folder("seek");
  const Work work = workIn("cholecystectomy", 40.0);
  const std::filesystem::path file = folder / "seek.h5";
  const double step = run(work, file) / static_cast<double>(work.motion.step.size());
  recorder::Recording recording(file);
  recorder::Seeker seeker(recording);
  std::vector<double> seconds;
  for (auto _ : bench) {
    Random random(11);
    seconds.clear();
    for (int i = 0; i < 40; ++i) {
      const auto to = static_cast<std::uint64_t>(random.uniform() * static_cast<double>(recording.stepCount()));
      const double begin = threadSeconds();
      seeker.seek(to);
      seconds.push_back(threadSeconds() - begin);
    }
    bench.SetIterationTime(quantile(seconds, 0.5));
  }
  const double longest = *std::max_element(seconds.begin(), seconds.end());
  bench.counters["max_ms"] = 1e3 * longest;
  bench.counters["over_a_step"] = quantile(seconds, 0.5) / step;
  figures().addLargest("seek.max_ms", 1e3 * longest);
}

}  // namespace
}  // namespace calot::bench::recording_bench

void calot::bench::registerRecordings() {
  using namespace recording_bench;

  for (const std::string scene : {"touch-liver", "cholecystectomy"}) {
    repeated(benchmark::RegisterBenchmark(("recording/overhead/" + scene).c_str(), overhead, scene), 2);
  }
  repeated(benchmark::RegisterBenchmark("recording/replay", replay), 2);
  repeated(benchmark::RegisterBenchmark("recording/segments", segments), 1);
  repeated(benchmark::RegisterBenchmark("recording/seek", seek), 2);
}
