// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/run_report.h"

#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "apps/calot/environment.h"
#include "apps/calot/replay_report.h"
#include "apps/calot/results.h"
#include "recorder/base/errors.h"

namespace calot::apps {

namespace {

void printJson(const FinishedRun& run, double seconds) {
  const recorder::RunReport& r = run.report;
  nlohmann::ordered_json out{{"attempt", run.attempt},
                             {"file", run.file},
                             {"outcome", wordFor(r.outcome)},
                             {"steps", r.steps},
                             {"seconds", seconds},
                             {"wall_seconds", r.wallSeconds},
                             {"missed_tolerance", missesJson(r.misses)},
                             {"ticks", r.ticks},
                             {"missed_deadlines", r.missedDeadlines},
                             {"largest_lateness_s", r.maxLateness},
                             {"clock_stretched_s", r.stretched},
                             {"pauses", r.pauses},
                             {"paused_s", r.paused}};
  if (!run.why.empty()) out["source_status"] = run.why;
  if (run.live) {
    out["real_time_thread"] = r.realTime;
    out["tick_cpu_mean_s"] = r.tickMean;
    out["tick_cpu_p999_s"] = r.tickP999;
    out["tick_cpu_largest_s"] = r.tickLargest;
    out["arenas_grown"] = r.arenasGrown;
    out["force_disagreements"] = r.disagreements;
  }
  printResult("record", out);
}

void printText(const FinishedRun& run, double seconds) {
  const recorder::RunReport& r = run.report;
  const bool failed = r.outcome == recorder::Outcome::technicalFailure && !run.why.empty();
  fmt::print("{}: attempt {}, {:.2f} s, {}{}{}\n", run.file, run.attempt, seconds, wordFor(r.outcome),
             failed ? ": " : "", failed ? run.why : "");
  if (r.misses.any > 0) fmt::print("{}: {}\n", run.file, describe(r.misses));
  if (run.paced) {
    fmt::print("{}: {} of {} ticks missed their deadline, at most {:.1f} ms late, clock stretched by {:.3f} s\n",
               run.live ? "live" : "paced", r.missedDeadlines, r.ticks, 1e3 * r.maxLateness, r.stretched);
  }
  if (run.live) {
    fmt::print(
        "haptic tick: {:.1f} us of CPU on average, {:.1f} us at 99.9 %, {:.1f} us at most; {}; {} arenas grown\n",
        1e6 * r.tickMean, 1e6 * r.tickP999, 1e6 * r.tickLargest,
        r.realTime ? "real-time thread" : "ordinary thread (no permission for real time)", r.arenasGrown);
  }
  if (r.pauses > 0) fmt::print("{} pauses of the source, {:.1f} s in all\n", r.pauses, r.paused);
}

}  // namespace

int tell(const FinishedRun& run, bool json) {
  Progress::erase();
  const double seconds = static_cast<double>(run.report.steps) * run.stepSeconds;
  if (json) {
    printJson(run, seconds);
  } else {
    printText(run, seconds);
  }
  if (run.report.disagreements > 0) {
    throw Error(
        ErrorKind::failure,
        fmt::format("{}: {} ticks got other forces on the haptic thread than when computed again; the recording "
                    "will not replay",
                    run.file, run.report.disagreements));
  }
  if (!run.report.fault.empty()) {
    throw Error(ErrorKind::failure, fmt::format("{}: {}", run.file, run.report.fault));
  }
  return 0;
}

}  // namespace calot::apps
