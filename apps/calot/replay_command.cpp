// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>
#include <thread>

#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "apps/calot/source_options.h"
#include "recorder/base/counted.h"
#include "recorder/base/files.h"
#include "recorder/live/worker_pool.h"
#include "recorder/recording/probe.h"
#include "recorder/replay.h"

namespace calot::apps {

namespace {

struct ReplayOptions {
  std::vector<std::string> files;
  std::string engine, broadPhase = "grid";
  JunitOptions junit;
  std::vector<std::size_t> segments;  ///< first and last; empty: all
  unsigned threads = 1, jobs = 1;
  bool anyway = false, apart = false, json = false;
};

ExitCode replay(const ReplayOptions& o) {
  if (!o.segments.empty() && o.files.size() > 1)
    throw Error(ErrorKind::invalid, "--segments are those of one recording: name one");
  if (!o.junit.file.empty()) recorder::refuseOutput(o.junit.file, o.junit.force);
  const MakeBroadPhase makeBroadPhase = broadPhaseOf(o.broadPhase);
  std::vector<recorder::ReplayReport> reports(o.files.size());
  const bool single = o.files.size() == 1;
  Progress progress(single ? "Replaying" : "Replaying " + recorder::counted(o.files.size(), "recording"), o.json,
                    "steps");
  std::vector<std::atomic<double>> shares(o.files.size());
  std::mutex failing;
  std::exception_ptr failure;
  const std::size_t jobs =
      std::min<std::size_t>(o.jobs == 0 ? std::thread::hardware_concurrency() : o.jobs, o.files.size());
  std::optional<recorder::ProbeProcesses> probes;
  if (!single) probes.emplace(static_cast<unsigned>(jobs));
  recorder::WorkerPool pool(static_cast<unsigned>(jobs));
  pool.run(o.files.size(), [&](std::size_t i) {
    recorder::ReplaySettings settings;
    settings.threads = o.threads;
    settings.engine = {o.apart, o.anyway, o.engine, makeBroadPhase};
    if (!o.segments.empty()) settings.part.emplace(o.segments.front(), o.segments.back());
    settings.progress = [&, i](std::uint64_t step, std::uint64_t of) {
      if (single) return progress.show(step, of);
      shares[i] = of > 0 ? static_cast<double>(step) / static_cast<double>(of) : 0.0;
      progress.showShare(std::accumulate(shares.begin(), shares.end(), 0.0) / static_cast<double>(shares.size()));
    };
    try {
      reports[i] = recorder::replayRecording(o.files[i], settings);
    } catch (...) {
      const std::lock_guard lock(failing);
      failure = std::current_exception();
      reports[i].path = o.files[i];
      reports[i].error = "failed inside";
    }
  });
  writeJunit(o.junit, "calot replay", reports);
  if (failure) std::rethrow_exception(failure);
  if (o.json) {
    nlohmann::json list = nlohmann::json::array();
    for (const recorder::ReplayReport& r : reports) list.push_back(reportJson(r));
    printResult("replay", {{"recordings", list}});
  } else {
    for (const recorder::ReplayReport& r : reports) printReport(r);
    const auto exact = std::count_if(reports.begin(), reports.end(), [](const recorder::ReplayReport& r) {
      return r.verdict == recorder::ReplayVerdict::exact;
    });
    if (reports.size() > 1) fmt::print("{} recordings, {} bit-exact\n", reports.size(), exact);
  }
  return worstOf(reports);
}

}  // namespace

void addReplay(CLI::App& app, Run& run) {
  const auto [command, o] =
      addCommand(app, run,
                 {"replay", "Re-simulates recordings and compares every digest and force.", "calot replay attempt.h5",
                  "calot replay recordings/*.h5 --jobs 0 --junit result.xml"},
                 replay);
  command->add_option("recordings", o->files, "recordings")->required();
  addThreads(*command, o->threads,
             "segments between keyframes that are verified at a time, of each recording; 0: one a processor");
  addThreads(*command, o->jobs, "recordings at a time; 0: one a processor", "--jobs");
  command->add_option("--segments", o->segments, "verify these alone, FIRST LAST, numbered from 0")->expected(2);
  addJunitOptions(*command, o->junit);
  command->add_flag("--anyway", o->anyway, "re-simulate recordings of another simulation version too (still exit 5)");
  CLI::Option* const apart = command->add_flag(
      "--apart", o->apart, "re-simulate in confined programs, as recordings of other simulation versions are");
  CLI::Option* const engine =
      command->add_option("--engine", o->engine, "this engine's program or module, whatever is installed");
  addBroadPhase(*command, o->broadPhase)->excludes(apart)->excludes(engine);
  command->add_flag("--json", o->json, "print the result as JSON");
}

}  // namespace calot::apps
