// SPDX-License-Identifier: GPL-3.0-or-later
// Do the simulation's intervals hold what a run eight times finer gives? One performer's samples, open-loop; the
// constants are those of the scene in both, so that what is tried is the part of step and mesh
// (docs/explanation/uncertainty.md has the table).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "analytics/uncertainty/uncertainty.h"
#include "recorder/loop.h"
#include "tests/accuracy/convergence/support/graded.h"

namespace calot::analytics {
namespace {

struct Coverage {
  int figures = 0;         ///< that depend on the simulation and have an interval
  int held = 0;            ///< whose interval holds the finer run's value
  int heldByNumerics = 0;  ///< whose interval does without the assumed constants' part
  int without = 0;         ///< figures without an interval
};

/// A reader's figures: not those of single phases, which repeat them, and not those of the simulation's own steps.
bool isAsked(const std::string& name) { return !name.starts_with("phase-") && name != "steps-missed"; }

/// The interval that step and mesh alone make.
std::pair<double, double> ofNumerics(const ValueInterval& i) {
  const double half = std::hypot(i.stepEffect, i.meshEffect);
  return {std::min(i.value, i.limit()) - half, std::max(i.value, i.limit()) + half};
}

Coverage coverage(const std::string& scene, double seconds) {
  const SceneDescription description = sceneOf(scene);
  std::vector<TickSamples> ticks = performedTicks(scene, seconds);
  ticks.resize(ticks.size() - ticks.size() % description.ticksPerStep);
  const Model::Built built = Model::build(description);
  Coverage count;
  if (!built.model) {
    ADD_FAILURE() << built.error;
    return count;
  }
  const recorder::AttemptHeader header = recorder::makeHeader(*built.model, {}, {}, {});
  const recorder::AttemptInputs inputs{ticks, {}, recorder::Outcome::completed, 1};
  const OpenLoopRun base = runIn(description, header, inputs, scene);
  const std::vector<ValueInterval> intervals = estimateUncertainty(description, header, inputs, base.values, 0);
  const OpenLoopRun fine = runIn(redivided(description, 1, 8.0), header, inputs, scene + ", eight times finer");
  std::printf("\n### %s, %.0f s, %llu and %llu tetrahedra\n\n", scene.c_str(), seconds,
              static_cast<unsigned long long>(base.tetrahedra), static_cast<unsigned long long>(fine.tetrahedra));
  std::printf("| figure | value | interval | eight times finer | |\n| --- | --- | --- | --- | --- |\n");
  for (const ValueInterval& i : intervals) {
    if (!isAsked(i.name)) continue;
    const auto finest = std::find_if(fine.values.begin(), fine.values.end(), [&](const CheckpointValue& v) {
      return v.name == i.name && v.subject == i.subject;
    });
    if (!i.lower || finest == fine.values.end() || !finest->value) {
      count.without += 1;
      continue;
    }
    if (*i.lower == *i.upper && *finest->value == i.value) continue;  // of the hands alone
    const bool held = *finest->value >= *i.lower && *finest->value <= *i.upper;
    const auto [lower, upper] = ofNumerics(i);
    count.figures += 1;
    count.held += held ? 1 : 0;
    count.heldByNumerics += *finest->value >= lower && *finest->value <= upper ? 1 : 0;
    std::printf("| %s %s | %.4g | %.4g to %.4g | %.4g | %s |\n", i.name.c_str(), i.subject.c_str(), i.value, *i.lower,
                *i.upper, *finest->value, held ? "in" : "out");
  }
  std::printf("\n%d of %d held, %d by step and mesh alone; %d without\n", count.held, count.figures,
              count.heldByNumerics, count.without);
  return count;
}

class IntervalCoverageHeavy : public testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(IntervalCoverageHeavy, HoldsARunEightTimesFiner) {
  if (std::getenv("CALOT_HEAVY") == nullptr) GTEST_SKIP() << "set CALOT_HEAVY";
  const auto [scene, seconds] = GetParam();
  const Coverage count = coverage(scene, seconds);
  ASSERT_GT(count.figures, 10);
  // The finest run of carving is another attempt: its hook meets a duct that no run which makes an interval touches.
  EXPECT_GE(count.held, (std::string(scene) == "carve-fat" ? 0.55 : 0.8) * count.figures);
}

INSTANTIATE_TEST_SUITE_P(Scenes, IntervalCoverageHeavy,
                         testing::Values(std::pair{"dissect-bed", 20.0}, std::pair{"carve-fat", 15.0},
                                         std::pair{"clip-and-cut", 20.0}),
                         [](const auto& which) {
                           std::string name = which.param.first;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

}  // namespace
}  // namespace calot::analytics
