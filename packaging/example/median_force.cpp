// SPDX-License-Identifier: GPL-3.0-or-later
// Replays a recording, and prints the verdict and the median of the forces that the hands felt.
#include <cstdio>
#include <exception>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "recorder/base/errors.h"
#include "recorder/engine/observer.h"
#include "recorder/replay.h"

namespace {

/// Collects what the re-simulation computes.
class Forces : public calot::recorder::Observer {
 public:
  void onStep(const calot::recorder::StepRecord& record) override {
    for (const calot::recorder::TickOutcome& tick : record.ticks) {
      for (const calot::recorder::HandTick& hand : tick.hand) {
        if (const double force = hand.force.norm(); force > 0.0) felt_.push_back(force);
      }
    }
  }
  void onEnd(calot::recorder::Outcome) override {}
  [[nodiscard]] const std::vector<double>& felt() const { return felt_; }

 private:
  std::vector<double> felt_;
};

int run(const char* file) {
  Forces forces;
  calot::recorder::ReplaySettings settings;
  settings.observers = [&forces](const auto&, const auto&) { return std::vector<calot::recorder::Observer*>{&forces}; };
  const calot::recorder::ReplayReport report = calot::recorder::replayRecording(file, settings);
  const bool exact = report.verdict == calot::recorder::ReplayVerdict::exact;
  const auto median = calot::analytics::median(forces.felt());
  std::printf("%s; %zu forces", exact ? "bit-exact" : "no exact replay", forces.felt().size());
  if (median) std::printf(", median %.3f N", *median);
  std::printf("\n");
  return exact ? 0 : 3;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 2) return run(argv[1]);
    std::fputs("usage: median_force RECORDING\n", stderr);
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "median_force: %s\n", error.what());
    return 1;
  }
}
