// SPDX-License-Identifier: GPL-3.0-or-later
// Every scene is drawn as it is under its weight: nothing moves, and everything sleeps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/sim/scene/support/scenes.h"
#include "tests/weight/support/rest_forces.h"

namespace calot {
namespace {

/// The scene without its assistant, who pulls on purpose.
SceneDescription leftAlone(const std::string& name) {
  SceneDescription scene = test::sceneNamed(name);
  scene.retraction.clear();
  return scene;
}

double driftOf(const StepResult& result) {
  double drift = 0.0;
  for (const OrganResult& organ : result.organ) drift = std::max(drift, organ.maxDisplacement);
  for (const VesselResult& vessel : result.vessel) drift = std::max(drift, vessel.maxDisplacement);
  for (const FatResult& fat : result.fat) drift = std::max(drift, fat.maxDisplacement);
  return drift;
}

bool allAsleep(const StepResult& result) {
  const auto asleep = [](const auto& part) { return part.asleep; };
  return std::all_of(result.organ.begin(), result.organ.end(), asleep) &&
         std::all_of(result.vessel.begin(), result.vessel.end(), asleep) &&
         std::all_of(result.fat.begin(), result.fat.end(), asleep);
}

void wakeAll(State& state) {
  for (SolidState& organ : state.organ) organ.quietSteps = 0;
  for (BeamState& vessel : state.vessel) vessel.quietSteps = 0;
  for (FatState& fat : state.fat) fat.solid.quietSteps = 0;
}

class ScenesAtRest : public testing::TestWithParam<const char*> {};

TEST_P(ScenesAtRest, HaveTheWeightOfASupineBody) {
  const Vec3 gravity = test::sceneNamed(GetParam()).gravity;
  EXPECT_NEAR(gravity.norm(), 9.81, 1e-3);
  EXPECT_NEAR(gravity[2] / gravity[1], std::tan(20.0 * 3.14159265358979 / 180.0), 1e-4) << "head up by 20 degrees";
}

TEST_P(ScenesAtRest, ForcesBalanceAtEveryNode) {
  const std::unique_ptr<const Model> model = test::buildModel(leftAlone(GetParam()));
  ASSERT_TRUE(model);
  const test::RestForces forces = test::restForces(*model);
  double left = 0.0;
  double moment = 0.0;
  for (std::size_t b = 0; b < model->bodies(); ++b) {
    EXPECT_TRUE(model->holds(b)) << b;
    for (const Vec3& f : forces.force[b]) left = std::max(left, f.norm());
    for (const Vec3& m : forces.moment[b]) moment = std::max(moment, m.norm());
  }
  std::printf("%s: weight %.3f N, left of it at a node %.1e N, moment %.1e N m\n", GetParam(), forces.weight.norm(),
              left, moment);
  EXPECT_LT(left, 1e-9 * forces.weight.norm());
  EXPECT_LT(moment, 1e-9 * forces.weight.norm() * 0.1);
}

/// A bed bears its organ by a small part of what would tear it.
TEST_P(ScenesAtRest, BedsAreFarFromTearing) {
  const std::unique_ptr<const Model> model = test::buildModel(leftAlone(GetParam()));
  ASSERT_TRUE(model);
  for (const ConnectiveModel& bed : model->connective()) {
    double largest = 0.0;
    double mean = 0.0;
    for (const Strand& strand : bed.tissue.strands()) {
      largest = std::max(largest, strand.load.norm() / strand.area);
      mean += strand.load.norm() / bed.tissue.area();
    }
    std::printf("%s: strands bear %.0f Pa, at most %.0f Pa\n", GetParam(), mean, largest);
    EXPECT_LT(largest, 0.5 * bed.tissue.material().strength);
  }
}

TEST_P(ScenesAtRest, SleepFromTheStart) {
  const std::unique_ptr<const Model> model = test::buildModel(leftAlone(GetParam()));
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (int i = 0; i < 1000; ++i) {
    const StepResult& result = rig.step(model->scene().hands[0].home);
    ASSERT_TRUE(allAsleep(result)) << i;
    ASSERT_EQ(driftOf(result), 0.0) << i;
  }
}

TEST_P(ScenesAtRest, FallAsleepAgainWhereTheyAreDrawn) {
  const std::unique_ptr<const Model> model = test::buildModel(leftAlone(GetParam()));
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  wakeAll(rig.state);
  for (int i = 0; i < 60; ++i) {
    const StepResult& result = rig.step(model->scene().hands[0].home);
    EXPECT_EQ(result.misses, 0U) << i;
    EXPECT_TRUE(i < 52 || allAsleep(result)) << i;
    EXPECT_LT(driftOf(result), 1e-9) << i;
  }
}

TEST_P(ScenesAtRest, StayWhereTheyAreDrawnWithoutSleep) {
  SceneDescription scene = leftAlone(GetParam());
  scene.solver.sleeping = false;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  double drift = 0.0;
  for (int i = 0; i < 1000; ++i) drift = std::max(drift, driftOf(rig.step(scene.hands[0].home)));
  std::printf("%s: drift in 10 s %.1e m\n", GetParam(), drift);
  EXPECT_LT(drift, 1e-4);
}

/// The equilibrium is stable: kicked, everything comes back.
TEST_P(ScenesAtRest, ComeBackAfterAKick) {
  SceneDescription scene = leftAlone(GetParam());
  scene.solver.sleeping = false;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (std::size_t o = 0; o < rig.state.organ.size(); ++o) {
    for (std::size_t n = 0; n < rig.state.organ[o].velocity.size(); ++n) {
      if (model->organs()[o].solid.row(n) >= 0) rig.state.organ[o].velocity[n] = Vec3(0.03, -0.05, 0.02);
    }
  }
  double largest = 0.0;
  double last = 0.0;
  for (int i = 0; i < 1000; ++i) {
    last = driftOf(rig.step(scene.hands[0].home));
    largest = std::max(largest, last);
  }
  std::printf("%s: kicked by %.2f mm, after 10 s away by %.4f mm\n", GetParam(), 1e3 * largest, 1e3 * last);
  EXPECT_GT(largest, 1e-4);
  EXPECT_LT(last, 1e-4);
}

/// The gallbladder's weight alone, no hand near, tears the rest of its bed once that is too small: spread evenly it
/// would hold while it has W / strength of area.
TEST(DissectBed, WeightTearsTheLastOfTheBed) {
  SceneDescription scene = leftAlone("dissect-bed");
  scene.solver.sleeping = false;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  const ConnectiveModel& bed = model->connective()[0];
  const std::vector<Strand>& strands = bed.tissue.strands();
  std::vector<std::pair<double, std::size_t>> order;  // from below
  for (std::size_t s = 0; s < strands.size(); ++s) {
    order.emplace_back(strands[s].a.of(model->organs()[bed.a].solid.rest())[1], s);
  }
  std::sort(order.begin(), order.end());
  test::Rig rig(*model);
  std::size_t burned = 0;
  double heldWith = 1.0;  // least share of the bed that held
  for (int step = 0; step < 3000; ++step) {
    ConnectiveState& state = rig.state.connective[0];
    for (std::size_t k = 0; step % 100 == 0 && k < strands.size() / 24 && burned < strands.size(); ++k, ++burned) {
      if (state.condition[order[burned].second] != StrandCondition::attached) continue;
      state.condition[order[burned].second] = StrandCondition::burned;
      state.alpha[order[burned].second] = 0.0;
    }
    const ConnectiveResult& result = rig.step(scene.hands[0].home).connective[0];
    if (result.attached == 0.0) break;
    if (result.torn == 0.0 && step % 100 == 99) heldWith = result.attached;
  }
  const ConnectiveShares shares = sharesOf(bed.tissue, rig.state.connective[0]);
  const double even = model->organs()[bed.a].solid.wholeMass() * scene.gravity.norm() /
                      (bed.tissue.material().strength * bed.tissue.area());
  std::printf("bed: %.3f torn by weight alone, %.3f held; spread evenly %.3f\n", shares.torn, heldWith, even);
  EXPECT_EQ(shares.attached, 0.0);
  EXPECT_GT(shares.torn, 0.5 * even);
  EXPECT_LT(shares.torn, 2.5 * even);
  EXPECT_LT(heldWith, 3.0 * even);
}

INSTANTIATE_TEST_SUITE_P(All, ScenesAtRest,
                         testing::Values("touch-liver", "clip-and-cut", "carve-fat", "dissect-bed", "cholecystectomy"),
                         [](const auto& scene) {
                           std::string name = scene.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

/// All that the assistant can be asked for, at once, in the whole operation (docs/reference/materials.md).
TEST(RetractionOfTheOperation, AtItsMostTearsNothing) {
  const SceneDescription scene = test::sceneNamed("cholecystectomy");
  ASSERT_EQ(scene.retraction.size(), 1U);
  ASSERT_GT(scene.retraction[0].stage, 0.0);
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  TickSamples still;
  still.camera = scene.camera;
  for (std::size_t h = 0; h < handCount; ++h) {
    still.hand[h].position = scene.hands[h].home;
    still.hand[h].instrument = scene.hands[h].instrument;
  }
  double attached = 0.0;
  for (int step = 0; step < 600; ++step) {
    std::vector<TickSamples> samples(scene.ticksPerStep, still);
    if (step < 20) samples[0].hand[0].buttons = button::retractMore;  // let go in the same step
    const StepResult& result = rig.stepper.step(rig.state, samples);
    EXPECT_EQ(result.misses, 0U) << step;
    for (const Event& event : result.events) EXPECT_EQ(event.kind, EventKind::retractionMore) << step;
    attached = result.connective[0].attached;
  }
  EXPECT_EQ(rig.state.retraction.goal[0], scene.retraction[0].most);
  EXPECT_EQ(retractionAt(rig.state.retraction, 0, 6.0).share, scene.retraction[0].most) << "it has arrived";
  EXPECT_EQ(attached, 1.0);
}

}  // namespace
}  // namespace calot
