// SPDX-License-Identifier: GPL-3.0-or-later
// Does the grade depend on the mesh, and on the step? One performer's samples, open-loop, in the same scene with other
// meshes and steps; every checkpoint of each run beside that of the finest (scripts/convergence.sh prints the whole).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "analytics/uncertainty/uncertainty.h"
#include "tests/accuracy/convergence/support/graded.h"

namespace calot::analytics {
namespace {

/// The same scene, divided otherwise in space and time.
struct Variant {
  double mesh = 1.0;  ///< tetrahedra of every organ, over those of the scene (redivided())
  std::uint32_t ticksPerStep = 10;

  [[nodiscard]] std::string name() const { return fmt::format("mesh x {}, {} ms", mesh, ticksPerStep); }
};

Graded run(const std::string& scene, const Variant& variant, const std::vector<TickSamples>& ticks) {
  return graded(scene + ", " + variant.name(), redivided(sceneOf(scene), variant.ticksPerStep, variant.mesh), ticks);
}

/// Table in the form of docs/explanation/mesh-and-step.md: a line a checkpoint, its value in the last run and the
/// relative difference of the others to it.
void print(const std::string& scene, const std::vector<Variant>& variants, const std::vector<Graded>& runs) {
  std::printf("\n### %s\n\n| checkpoint | %s |", scene.c_str(), variants.back().name().c_str());
  for (std::size_t i = 0; i + 1 < runs.size(); ++i) std::printf(" %s |", variants[i].name().c_str());
  std::printf("\n| --- | --- |");
  for (std::size_t i = 0; i + 1 < runs.size(); ++i) std::printf(" --- |");
  std::printf("\n| tetrahedra | %zu |", runs.back().tetrahedra);
  for (std::size_t i = 0; i + 1 < runs.size(); ++i) std::printf(" %zu |", runs[i].tetrahedra);
  std::printf("\n");
  for (const auto& [name, finest] : runs.back().values) {
    if (!finest.value) continue;
    std::printf("| %s | %.4g %s |", name.c_str(), *finest.value, finest.unit.c_str());
    for (std::size_t i = 0; i + 1 < runs.size(); ++i) {
      const auto found = runs[i].values.find(name);
      if (found == runs[i].values.end() || !found->second.value) {
        std::printf(" none |");
      } else if (*found->second.value == *finest.value) {
        std::printf(" same |");
      } else if (*finest.value == 0.0) {
        std::printf(" %.4g |", *found->second.value);
      } else {
        std::printf(" %+.1f %% |", 100.0 * (*found->second.value / *finest.value - 1.0));
      }
    }
    std::printf("\n");
  }
}

std::vector<Graded> runAll(const std::string& scene, const std::vector<Variant>& variants, double seconds) {
  std::vector<TickSamples> ticks = performedTicks(scene, seconds);
  std::uint32_t longest = 1;
  for (const Variant& variant : variants) longest = std::max(longest, variant.ticksPerStep);
  ticks.resize(ticks.size() - ticks.size() % longest);  // whole steps of all
  std::vector<Graded> runs;
  for (const Variant& variant : variants) runs.push_back(run(scene, variant, ticks));
  print(scene, variants, runs);
  return runs;
}

/// Figures of the hands' motion alone are the same to the bit, whatever the mesh and the step, if each step divides the
/// longest.
void expectSameMotion(const std::vector<Graded>& runs) {
  int compared = 0;
  for (const auto& [name, finest] : runs.back().values) {
    if (finest.origin != Origin::samples || name.starts_with("phase-")) continue;  // phases begin by what is simulated
    for (const Graded& other : runs) {
      const auto found = other.values.find(name);
      ASSERT_NE(found, other.values.end()) << name;
      EXPECT_EQ(found->second.value, finest.value) << name;
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
}

/// A share that was burned or removed stays within a band of the finest run's.
void expectWithin(const std::vector<Graded>& runs, const std::string& name, double band) {
  for (const Graded& graded : runs) {
    const auto found = graded.values.find(name);
    const auto finest = runs.back().values.find(name);
    ASSERT_NE(found, graded.values.end()) << name;
    ASSERT_NE(finest, runs.back().values.end()) << name;
    ASSERT_TRUE(found->second.value && finest->second.value) << name;
    ASSERT_GT(*finest->second.value, 0.0) << name;
    EXPECT_NEAR(*found->second.value / *finest->second.value, 1.0, band) << name;
  }
}

/// The scene's own mesh and step, twice the step, and twice the tetrahedra.
TEST(MeshAndStep, OfADissection) {
  const std::vector<Graded> runs = runAll("dissect-bed", {{1.0, 20}, {1.0, 10}, {2.0, 10}}, 20.0);
  expectSameMotion(runs);
  for (const char* organ : {"gallbladder", "liver"}) {
    expectWithin(runs, std::string("organ-burned ") + organ, 0.25);
    expectWithin(runs, std::string("contact-time-union ") + organ, 0.05);
  }
  for (const char* hand : {"left", "right"}) {
    expectWithin(runs, std::string("force-mean ") + hand, 0.1);
    expectWithin(runs, std::string("force-p99 ") + hand, 0.1);
    expectWithin(runs, std::string("force-impulse ") + hand, 0.1);
    expectWithin(runs, std::string("force-maximum ") + hand, 0.15);
  }
  // 0.9 s of this attempt, in strokes that begin and end in the air: 0.19 s less in steps of 20 ms.
  expectWithin(runs, "cautery-without-contact right", 0.25);
}

/// Not with 20 ms: there a hold that a step misses is no hold, and all that follows is another attempt.
TEST(CarvingHeavy, OnTwoMeshes) {
  if (std::getenv("CALOT_HEAVY") == nullptr) GTEST_SKIP() << "set CALOT_HEAVY";
  const std::vector<Graded> runs = runAll("carve-fat", {{1.0, 10}, {2.0, 10}}, 15.0);
  expectSameMotion(runs);
  expectWithin(runs, "fat-remaining", 0.15);
  expectWithin(runs, "fat-remaining-inside", 0.15);
}

class MeshAndStepHeavy : public testing::TestWithParam<const char*> {};

TEST_P(MeshAndStepHeavy, OfAWholeAttempt) {
  const char* heavy = std::getenv("CALOT_HEAVY");
  if (heavy == nullptr) GTEST_SKIP() << "set CALOT_HEAVY (to so many seconds of an attempt, or to 1 for all of it)";
  const double seconds = std::atof(heavy) > 1.0 ? std::atof(heavy) : 300.0;
  const std::vector<Graded> runs =
      runAll(GetParam(), {{1.0, 20}, {0.5, 10}, {1.0, 10}, {2.0, 10}, {1.0, 5}, {2.0, 5}}, seconds);
  expectSameMotion(runs);
}

INSTANTIATE_TEST_SUITE_P(Scenes, MeshAndStepHeavy,
                         testing::Values("dissect-bed", "carve-fat", "clip-and-cut", "cholecystectomy"),
                         [](const auto& which) {
                           std::string name = which.param;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

}  // namespace
}  // namespace calot::analytics
