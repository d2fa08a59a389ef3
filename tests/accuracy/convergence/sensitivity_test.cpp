// SPDX-License-Identifier: GPL-3.0-or-later
// How much does a figure depend on a constant of the scene? One performer's samples, open-loop, in the same scene with
// one constant at a time 30 % smaller and 30 % larger; scripts/sensitivity.sh prints the change of each figure of the
// paper's Table 2 and of each force figure.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "analytics/uncertainty/uncertainty.h"
#include "recorder/live/worker_pool.h"
#include "tests/accuracy/convergence/support/graded.h"

namespace calot::analytics {
namespace {

/// Of the paper's Table 2, with the torn share beside the bed's remainder, or of force.
bool isShown(const std::string& name) {
  static const std::vector<std::string> shown = {
      "elapsed-time",         "path-length",     "fat-remaining", "cystic-contact-time",
      "connective-remaining", "connective-torn", "organ-burned",  "force-"};
  return std::any_of(shown.begin(), shown.end(), [&](const std::string& s) { return name.starts_with(s); });
}

struct Sensitivity {
  std::vector<std::string> constant;
  Graded base;
  std::vector<std::array<Graded, 2>> perturbed;  ///< 30 % smaller, 30 % larger

  [[nodiscard]] double value(const Graded& run, const std::string& figure) const {
    const auto found = run.values.find(figure);
    EXPECT_TRUE(found != run.values.end() && found->second.value) << figure;
    return found != run.values.end() && found->second.value ? *found->second.value : 0.0;
  }
};

/// Each run has a session of its own; runs share the processors.
Sensitivity sensitivity(const std::string& scene, double seconds, const std::vector<std::string>& names) {
  const std::vector<TickSamples> ticks = performedTicks(scene, seconds);
  Sensitivity out;
  std::vector<std::pair<std::string, SceneDescription>> runs{{scene, sceneOf(scene)}};
  for (const SceneConstant& constant : sceneConstants()) {
    if (!names.empty() && std::find(names.begin(), names.end(), constant.name) == names.end()) continue;
    bool there = true;
    for (const double factor : {1.0 - assumedChange, 1.0 + assumedChange}) {
      SceneDescription description = sceneOf(scene);
      there = there && constant.multiply(description, factor);
      if (there) runs.emplace_back(fmt::format("{}, {} x {}", scene, constant.name, factor), std::move(description));
    }
    if (there) out.constant.push_back(constant.name);
  }
  std::vector<Graded> results(runs.size());
  recorder::WorkerPool pool(0);
  pool.run(runs.size(), [&](std::size_t i) { results[i] = graded(runs[i].first, runs[i].second, ticks); });
  out.base = std::move(results[0]);
  for (std::size_t i = 1; i < results.size(); i += 2)
    out.perturbed.push_back({std::move(results[i]), std::move(results[i + 1])});
  return out;
}

std::string changeOf(const Graded& run, const std::string& name, double base) {
  const auto found = run.values.find(name);
  if (found == run.values.end() || !found->second.value) return "none";
  if (*found->second.value == base) return "same";
  if (base == 0.0) return fmt::format("{:.3g}", *found->second.value);
  return fmt::format("{:+.1f} %", 100.0 * (*found->second.value / base - 1.0));
}

/// A line for each constant and figure that changes, sorted by constant.
void print(const std::string& scene, double seconds, const Sensitivity& s) {
  std::printf(
      "\n### %s, at most %g s\n\n| constant | figure | value | -30 %% | +30 %% |\n| --- | --- | --- | --- | --- |\n",
      scene.c_str(), seconds);
  for (std::size_t i = 0; i < s.constant.size(); ++i) {
    bool any = false;
    for (const auto& [name, value] : s.base.values) {
      if (!isShown(name) || !value.value) continue;
      const std::string smaller = changeOf(s.perturbed[i][0], name, *value.value);
      const std::string larger = changeOf(s.perturbed[i][1], name, *value.value);
      if (smaller == "same" && larger == "same") continue;
      any = true;
      std::printf("| `%s` | %s | %.4g %s | %s | %s |\n", s.constant[i].c_str(), name.c_str(), *value.value,
                  value.unit.c_str(), smaller.c_str(), larger.c_str());
    }
    if (!any) std::printf("| `%s` | every figure | | same | same |\n", s.constant[i].c_str());
  }
}

/// A softer bed is held with less force, a stiffer one with more; skin that chars in less time is burned more.
TEST(Sensitivity, HasTheRightSign) {
  const double seconds = 12.0;
  const Sensitivity s = sensitivity("dissect-bed", seconds, {"connective.*.stiffness", "cautery.charTime"});
  print("dissect-bed", seconds, s);
  ASSERT_EQ(s.constant, (std::vector<std::string>{"connective.*.stiffness", "cautery.charTime"}));
  const auto value = [&](const Graded& run, const std::string& figure) { return s.value(run, figure); };
  const double force = value(s.base, "force-mean left");
  EXPECT_LT(value(s.perturbed[0][0], "force-mean left"), force);
  EXPECT_GT(value(s.perturbed[0][1], "force-mean left"), force);
  const double burned = value(s.base, "organ-burned gallbladder");
  EXPECT_GT(value(s.perturbed[1][0], "organ-burned gallbladder"), burned);
  EXPECT_LT(value(s.perturbed[1][1], "organ-burned gallbladder"), burned);
  EXPECT_EQ(value(s.perturbed[0][0], "path-length left"), value(s.base, "path-length left")) << "open loop";
}

class SensitivityHeavy : public testing::TestWithParam<const char*> {};

TEST_P(SensitivityHeavy, OfEveryFigure) {
  const char* heavy = std::getenv("CALOT_HEAVY");
  if (heavy == nullptr) GTEST_SKIP() << "set CALOT_HEAVY (to so many seconds of an attempt, or to 1 for all of it)";
  const double seconds = std::atof(heavy) > 1.0 ? std::atof(heavy) : 300.0;
  const Sensitivity s = sensitivity(GetParam(), seconds, {});
  print(GetParam(), seconds, s);
  EXPECT_GT(s.constant.size(), 10U);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SensitivityHeavy,
                         testing::Values("dissect-bed", "carve-fat", "clip-and-cut", "cholecystectomy"),
                         [](const auto& which) {
                           std::string name = which.param;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

}  // namespace
}  // namespace calot::analytics
