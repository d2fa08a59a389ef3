// SPDX-License-Identifier: GPL-3.0-or-later
// Intervals of the simulation: orthogonal design, known effects, known limits.
#include "analytics/uncertainty/value_interval.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/uncertainty/uncertainty.h"
#include "recorder/formats/scene_file.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

/// A figure that reads v + a h + b s, h the step, s the elements' size, plus something of each factor.
struct Figure {
  double value = 0.0, ofStep = 0.0, ofMesh = 0.0;
  std::array<double, designFactors> ofFactor{};

  [[nodiscard]] CheckpointValue at(double step, double size, std::optional<std::size_t> run = {}) const {
    double v = value + ofStep * step + ofMesh * size;
    for (std::size_t f = 0; run && f < designFactors; ++f) v += designSign(*run, f) * ofFactor[f];
    return makeValue(*findCheckpoint("path-length"), "left", Origin::resimulated, v);
  }

  [[nodiscard]] VariedValues varied() const {
    VariedValues out;
    out.stepRatio = 2.0;
    out.meshRatio = std::cbrt(2.0);
    out.smallerStep = {at(1.0 / out.stepRatio, 1.0)};
    out.finerMesh = {at(1.0, 1.0 / out.meshRatio)};
    for (std::size_t run = 0; run < designRuns; ++run) out.design.push_back({at(1.0, 1.0, run)});
    return out;
  }
};

TEST(Design, TellsElevenFactorsApart) {
  for (std::size_t a = 0; a < designFactors; ++a) {
    int balance = 0;
    for (std::size_t run = 0; run < designRuns; ++run) balance += designSign(run, a);
    EXPECT_EQ(balance, 0) << a;
    for (std::size_t b = 0; b < a; ++b) {
      int product = 0;
      for (std::size_t run = 0; run < designRuns; ++run) product += designSign(run, a) * designSign(run, b);
      EXPECT_EQ(product, 0) << a << " and " << b;
    }
  }
}

TEST(Design, ConstantsLeadToTheNumbersThatTheyName) {
  SceneDescription scene;
  for (const char* name : {"liver", "gallbladder"}) scene.organs.emplace_back().name = name;
  for (OrganDescription& organ : scene.organs) organ.burnThrough = 2.0;
  scene.vessels.emplace_back().burnThrough = 1.0;
  ConnectiveDescription& bed = scene.connective.emplace_back();
  for (double* constant : {&bed.stiffness, &bed.damping, &bed.strength, &bed.fadeTime}) *constant = 1.0;
  scene.fat.emplace_back().attachments.emplace_back().stiffness = 3.0;
  scene.retraction.emplace_back();
  const SceneDescription before = scene;
  for (const SceneConstant& constant : sceneConstants()) EXPECT_TRUE(constant.multiply(scene, 2.0)) << constant.name;
  EXPECT_EQ(scene.organs[1].material.youngModulus, 2.0 * before.organs[1].material.youngModulus);
  EXPECT_EQ(scene.connective[0].fractureEnergy, 4.0 * before.connective[0].fractureEnergy);
  EXPECT_EQ(scene.fat[0].attachments[0].stiffness, 6.0);
  EXPECT_EQ(scene.hands[1].slipForce, 2.0 * before.hands[1].slipForce);
  EXPECT_EQ(scene.cautery.spot, 2.0 * before.cautery.spot);
  scene.vessels.clear();
  EXPECT_FALSE(findSceneConstant("vessels.*.wall")->multiply(scene, 2.0)) << "a scene without vessels";
}

TEST(Design, NamesConstantsOnceEach) {
  std::vector<std::string> names;
  for (const AssumedFactor& factor : assumedFactors()) {
    names.insert(names.end(), factor.constants.begin(), factor.constants.end());
    names.insert(names.end(), factor.inverse.begin(), factor.inverse.end());
  }
  for (const std::string& name : names) {
    EXPECT_NE(findSceneConstant(name), nullptr) << name;
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
  }
}

/// Every run of the design is a scene that can be simulated, and none is the scene itself.
TEST(Design, MakesScenesThatCanBeBuilt) {
  for (const char* name : {"dissect-bed", "cholecystectomy"}) {
    const SceneDescription scene =
        recorder::loadScene(std::string(CALOT_SOURCE_DIR "/assets/scenes/") + name + ".json").description;
    for (std::size_t run = 0; run < designRuns; ++run) {
      const SceneDescription changed = perturbed(scene, run);
      ASSERT_FALSE(changed.connective.empty());
      EXPECT_NE(changed.connective[0].stiffness, scene.connective[0].stiffness);
      // Strength and stiffness at opposite ends: the law of the bed must still be one.
      EXPECT_EQ(cohesiveFault(changed.connective[0]), "") << name << " run " << run;
    }
  }
}

TEST(Redivided, ShortensEveryPartByOneRatio) {
  const SceneDescription scene =
      recorder::loadScene(CALOT_SOURCE_DIR "/assets/scenes/cholecystectomy.json").description;
  const SceneDescription fine = redivided(scene, 5, 8.0);
  EXPECT_EQ(fine.ticksPerStep, 5U);
  EXPECT_EQ(fine.organs[0].tetrahedra, 8 * scene.organs[0].tetrahedra);
  EXPECT_EQ(fine.vessels[0].elements, 2 * scene.vessels[0].elements);
  EXPECT_EQ(fine.connective[0].strands, 4 * scene.connective[0].strands);
  EXPECT_EQ(fine.fat[0].cellsPerCube, 2U) << "4 cells by two";
}

/// Of first order in step and size, the limit is found; the interval holds it, and the value.
TEST(ValueInterval, HoldsTheLimitOfFirstOrder) {
  Figure figure{3.0, 0.2, -0.1, {}};
  const std::vector<CheckpointValue> base{figure.at(1.0, 1.0)};
  const auto intervals = intervalsOf(base, figure.varied());
  ASSERT_EQ(intervals.size(), 1U);
  const ValueInterval& i = intervals[0];
  EXPECT_NEAR(i.stepEffect, -0.2, 1e-12);
  EXPECT_NEAR(i.meshEffect, 0.1, 1e-12);
  EXPECT_NEAR(i.limit(), 3.0, 1e-12);
  EXPECT_LT(i.constantsSpread, 1e-12);
  const double half = std::hypot(0.2, 0.1);
  EXPECT_NEAR(*i.lower, 3.0 - half, 1e-12);
  EXPECT_NEAR(*i.upper, i.value + half, 1e-12) << "the difference may have the other sign";
  ASSERT_EQ(i.worlds().size(), 4 + designRuns);
  EXPECT_EQ(i.worlds()[0], i.value);
  EXPECT_NEAR(i.worlds()[3], 3.0, 1e-12);
}

/// The spread is that of constants anywhere within the change alike: E / sqrt 3 each, independent of each other.
TEST(ValueInterval, AddsTheVarianceOfEachFactor) {
  Figure figure{10.0, 0.0, 0.0, {}};
  figure.ofFactor[2] = 0.3;
  figure.ofFactor[9] = -0.4;
  const auto intervals = intervalsOf({figure.at(1.0, 1.0)}, figure.varied());
  EXPECT_NEAR(intervals[0].constantsSpread, 0.5 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(*intervals[0].upper - *intervals[0].lower, 2.0 * coverageFactor * 0.5 / std::sqrt(3.0), 1e-12);
}

TEST(ValueInterval, IsAPointWhereNothingChangesIt) {
  const Figure figure{0.7, 0.0, 0.0, {}};
  const auto intervals = intervalsOf({figure.at(1.0, 1.0)}, figure.varied());
  EXPECT_EQ(*intervals[0].lower, 0.7);
  EXPECT_EQ(*intervals[0].upper, 0.7);
}

TEST(ValueInterval, StaysAboveZeroWhereNoRunIsBelow) {
  Figure figure{0.1, 0.2, 0.0, {}};
  figure.ofFactor[0] = 0.25;
  EXPECT_EQ(*intervalsOf({figure.at(1.0, 1.0)}, figure.varied())[0].lower, 0.0);
  figure.value = -0.1;  // now some runs are below
  EXPECT_LT(*intervalsOf({figure.at(1.0, 1.0)}, figure.varied())[0].lower, -0.1);
}

TEST(ValueInterval, SaysWhereAFigureIsGone) {
  const Figure figure{0.7, 0.1, 0.0, {}};
  VariedValues varied = figure.varied();
  varied.smallerStep[0] = makeMissing(*findCheckpoint("path-length"), "left", Origin::resimulated,
                                      Availability::notApplicable, "nothing was done");
  const auto intervals = intervalsOf({figure.at(1.0, 1.0)}, varied);
  EXPECT_FALSE(intervals[0].lower);
  expectNames(intervals[0].reason, {});
  EXPECT_FALSE(intervals[0].contains(0.7));
  EXPECT_TRUE(intervals[0].worlds().empty());
}

TEST(ValueInterval, IsNotMadeOfWhatHasNoValue) {
  const Figure figure{0.7, 0.1, 0.0, {}};
  EXPECT_TRUE(intervalsOf({makeMissing(*findCheckpoint("path-length"), "left", Origin::resimulated,
                                       Availability::notAvailable, "lost")},
                          figure.varied())
                  .empty());
}

}  // namespace
}  // namespace calot::analytics
