// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "recorder/sources/performer.h"
#include "recorder/sources/pointing.h"
#include "tests/recorder/sources/support/test_scene.h"
#include "tests/support/fault.h"

namespace calot::recorder::performer_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

PerformerProfile profileOf(const std::string& name) {
  return loadPerformer(fs::path(CALOT_SOURCE_DIR) / "assets" / "performers" / (name + ".json"));
}

PerformerProfile exact() {
  PerformerProfile p = profileOf("skilled");
  p.motor.endpointNoise = p.motor.tremorAmplitude = p.motor.wanderAmplitude = p.motor.rollSpread = 0.0;
  p.perception.lateralError = p.perception.depthError = p.perception.reactionSpread = 0.0;
  p.decision.pressSpread = p.decision.pauseSpread = 0.0;
  return p;
}

TEST(PerformerSource, sameSeedSameSamplesOtherSeedOthers) {
  const SceneDescription scene = test::roundScene();
  for (const char* name : {"skilled", "unskilled"}) {
    const PerformerProfile profile = profileOf(name);
    PerformerSource a(profile, scene, 5), b(profile, scene, 5), c(profile, scene, 6);
    EXPECT_EQ(a.ticks(), b.ticks());
    TickSamples x, y, z;
    bool differs = a.ticks() != c.ticks();
    for (std::uint64_t tick = 0; a.next(tick, x); ++tick) {
      ASSERT_TRUE(b.next(tick, y));
      for (std::size_t h = 0; h < 2; ++h) {
        ASSERT_EQ(x.hand[h].position, y.hand[h].position);
        ASSERT_EQ(x.hand[h].orientation.coeffs(), y.hand[h].orientation.coeffs());
        ASSERT_EQ(x.hand[h].jaw, y.hand[h].jaw);
      }
      if (c.next(tick, z)) differs = differs || x.hand[0].position != z.hand[0].position;
    }
    EXPECT_TRUE(differs);
    EXPECT_FALSE(a.next(a.ticks(), x));
  }
}

TEST(PerformerSource, saysWhoItIs) {
  const PerformerSource source(profileOf("unskilled"), test::roundScene(), 1);
  EXPECT_EQ(source.provenance().kind, OperatorKind::performer);
  EXPECT_EQ(source.provenance().profile, "unskilled");
  EXPECT_EQ(source.provenance().profileVersion, profileOf("unskilled").version);
  EXPECT_TRUE(source.provenance().sourceFile.empty());
}

TEST(PerformerSource, anExactHandPressesEveryTargetByItsDepthAndComesHome) {
  const SceneDescription scene = test::roundScene();
  const PerformerProfile profile = exact();
  PerformerSource source(profile, scene, 11);
  std::array<std::vector<Vec3>, 2> path;
  TickSamples samples;
  for (std::uint64_t tick = 0; source.next(tick, samples); ++tick) {
    for (std::size_t h = 0; h < 2; ++h) path[h].push_back(samples.hand[h].position);
  }
  for (const Hand hand : {Hand::left, Hand::right}) {
    const auto h = static_cast<std::size_t>(hand);
    ASSERT_EQ(source.targets(hand).size(), profile.decision.touches);
    std::set<std::size_t> organs;
    for (const TouchTarget& target : source.targets(hand)) {
      organs.insert(target.organ);
      const Vec3 pressed = target.point - profile.decision.pressDepth * target.normal;
      int ticks = 0;
      for (const Vec3& p : path[h]) ticks += (p - pressed).norm() < 2e-6 ? 1 : 0;
      EXPECT_GE(ticks, static_cast<int>(1000.0 * profile.decision.dwell));
    }
    EXPECT_EQ(organs.size(), 2U);  // both organs are touched
    EXPECT_LT((path[h].front() - scene.hands[h].home).norm(), 2e-6);
    EXPECT_LT((path[h].back() - scene.hands[h].home).norm(), 2e-6);
  }
}

TEST(PerformerSource, strokesAreMinimumJerkAndFollowEachOther) {
  PerformerSource source(exact(), test::roundScene(), 3);
  std::array<std::vector<Vec3>, 2> path;
  TickSamples samples;
  for (std::uint64_t tick = 0; source.next(tick, samples); ++tick) {
    for (std::size_t h = 0; h < 2; ++h) path[h].push_back(samples.hand[h].position);
  }
  for (const Hand hand : {Hand::left, Hand::right}) {
    const auto h = static_cast<std::size_t>(hand);
    const std::vector<Stroke>& strokes = source.strokes(hand);
    for (std::size_t i = 0; i < strokes.size(); ++i) {
      const Stroke& s = strokes[i];
      if (i > 0) {
        EXPECT_EQ(s.from, strokes[i - 1].to);
        EXPECT_GE(s.start, strokes[i - 1].start + strokes[i - 1].duration - 1e-12);
      }
      // The greatest speed, in the middle, is 15/8 of the mean.
      const auto tick = static_cast<std::size_t>(std::round((s.start + 0.5 * s.duration) * 1000.0));
      const double speed = (path[h].at(tick + 10) - path[h].at(tick - 10)).norm() / 0.020;
      EXPECT_NEAR(speed, 1.875 * (s.to - s.from).norm() / s.duration, 1e-3);
    }
  }
}

TEST(PerformerSource, noiseGrowsWithTheStrokesLength) {
  PerformerProfile profile = exact();
  profile.motor.endpointNoise = 0.05;
  double sum = 0.0;
  int count = 0;
  const SceneDescription scene = test::roundScene();
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const PerformerSource source(profile, scene, seed);
    const Stroke& first = source.strokes(Hand::right).front();
    const TouchTarget& target = source.targets(Hand::right).front();
    // Its standard deviation on each axis is 5 % of the way that was meant.
    const double meant = (target.approach - first.from).norm();
    const Vec3 off = (first.to - target.approach) / (0.05 * meant);
    sum += off.squaredNorm();
    count += 3;
  }
  // chi-square with 180 degrees of freedom: 1 +- 4 standard deviations of 0.105
  EXPECT_NEAR(sum / count, 1.0, 0.42);
}

TEST(PerformerSource, tremorHasItsAmplitudeAndBand) {
  Random random(99);
  double power = 0.0;
  int crossings = 0, n = 0;
  const int hands = 20;
  for (int k = 0; k < hands; ++k) {
    const Unsteadiness tremor(0.0001, 8.0, 12.0, random);
    double last = tremor.at(0.0).x();
    for (int i = 1; i <= 10000; ++i, ++n) {
      const double x = tremor.at(0.001 * i).x();
      power += x * x;
      crossings += (x < 0.0) != (last < 0.0) ? 1 : 0;
      last = x;
    }
  }
  EXPECT_NEAR(std::sqrt(power / n), 0.0001, 0.00001);
  const double frequency = 0.5 * crossings / (10.0 * hands);
  EXPECT_GT(frequency, 8.0);
  EXPECT_LT(frequency, 12.0);
}

TEST(PerformerSource, handsTakeTurnsUnlessBimanual) {
  const SceneDescription scene = test::roundScene();
  const auto overlap = [&](const PerformerProfile& profile) {
    const PerformerSource source(profile, scene, 2);
    const auto& l = source.strokes(Hand::left);
    const auto& r = source.strokes(Hand::right);
    double together = 0.0;
    for (std::size_t i = 0; i + 1 < l.size(); ++i) {  // without the way home
      for (std::size_t j = 0; j + 1 < r.size(); ++j) {
        together += std::max(
            0.0, std::min(l[i].start + l[i].duration, r[j].start + r[j].duration) - std::max(l[i].start, r[j].start));
      }
    }
    return together;
  };
  EXPECT_EQ(overlap(profileOf("unskilled")), 0.0);
  EXPECT_GT(overlap(profileOf("skilled")), 1.0);
}

TEST(PerformerSource, aHandThatReachesNothingIsRefused) {
  SceneDescription scene = test::roundScene();
  scene.camera.orientation = Quat::Identity() * scene.camera.orientation;
  scene.camera.position = Vec3(0.0, 0.0, -0.9);
  scene.camera.orientation = quaternionOf((Mat3() << 1, 0, 0, 0, -1, 0, 0, 0, -1).finished());  // looks away
  expectFault(ErrorKind::invalid, "", {"left hand"}, [&] { PerformerSource(profileOf("skilled"), scene, 1); });
}

TEST(TouchTargets, lieOnTheSurfaceInSightAndReachable) {
  const SceneDescription scene = test::roundScene();
  const SceneSurfaces surfaces(scene);
  for (std::size_t h = 0; h < 2; ++h) {
    const std::vector<TouchTarget> targets = touchTargets(scene, surfaces, h, 0.02);
    ASSERT_GT(targets.size(), 20U);
    for (const TouchTarget& t : targets) {
      EXPECT_NEAR(surfaces.signedDistance(t.organ, t.point), 0.0, 1e-9);
      EXPECT_GT(t.normal.dot(scene.camera.position - t.point), 0.0);
      EXPECT_LT(t.normal.dot(t.point - scene.hands[h].port), 0.0);
      EXPECT_GE(surfaces.signedDistance(t.approach), 0.005);
      EXPECT_FALSE(surfaces.firstHit(scene.camera.position, t.point + 0.001 * t.normal).has_value());
    }
  }
}

TEST(PerformerProfile, profilesOfTheProjectLoadAndDifferAsTheirNamesSay) {
  const PerformerProfile skilled = profileOf("skilled"), unskilled = profileOf("unskilled");
  EXPECT_EQ(skilled.decision.touches, unskilled.decision.touches);  // the same task
  // Economy: who was taught searches less, spares fat and ends a stroke with its tissue.
  const auto& s = skilled.operation;
  const PerformerProfile::Operation i = profileOf("intermediate").operation;
  const auto& u = unskilled.operation;
  for (const auto field : {&PerformerProfile::Operation::searches, &PerformerProfile::Operation::strokes}) {
    EXPECT_LT(s.*field, i.*field);
    EXPECT_LT(i.*field, u.*field);
  }
  for (const auto field : {&PerformerProfile::Operation::cleared, &PerformerProfile::Operation::overrun,
                           &PerformerProfile::Operation::pullOff, &PerformerProfile::Operation::pedalLag,
                           &PerformerProfile::Operation::stretch}) {
    EXPECT_LT(s.*field, i.*field);
    EXPECT_LT(i.*field, u.*field);
  }
  EXPECT_LT(skilled.motor.endpointNoise, unskilled.motor.endpointNoise);
  EXPECT_LT(skilled.perception.depthError, unskilled.perception.depthError);
}

json validProfile() {
  std::ifstream in(fs::path(CALOT_SOURCE_DIR) / "assets" / "performers" / "skilled.json");
  return json::parse(in);
}

std::optional<Error> faultOf(const json& profile) {
  const fs::path file = fs::path(testing::TempDir()) / "calot_profile.json";
  std::ofstream(file) << profile.dump();
  return caught([&] { loadPerformer(file); });
}

TEST(PerformerProfile, faultsAreNamedWithTheirPlace) {
  EXPECT_FALSE(faultOf(validProfile()));
  json p = validProfile();
  p["motor"]["strokeSpeed"] = 0;
  expectFault(ErrorKind::damaged, "calot_profile.json: /motor/strokeSpeed", {"0", "[0.001, 1]"}, faultOf(p));
  p = validProfile();
  p["decision"]["touches"] = 0;
  expectFault(ErrorKind::damaged, "calot_profile.json: /decision/touches", {"0", "[1, 50]"}, faultOf(p));
  p = validProfile();
  p["elapsedTime"] = 38.86;
  expectFault(ErrorKind::damaged, "calot_profile.json: /elapsedTime", {}, faultOf(p));
  p = validProfile();
  p["motor"]["tremorUpper"] = 5;
  expectFault(ErrorKind::damaged, "calot_profile.json: /motor/tremorUpper", {"\"tremorLower\""}, faultOf(p));
  p = validProfile();
  p["perception"].erase("depthError");
  expectFault(ErrorKind::damaged, "calot_profile.json: /perception", {"\"depthError\""}, faultOf(p));
}

TEST(FindPerformer, byNameOrPath) {
  const std::vector<fs::path> roots{fs::path(CALOT_SOURCE_DIR) / "assets"};
  EXPECT_EQ(findPerformer("skilled", roots).filename(), "skilled.json");
  expectFault(ErrorKind::invalid, "", {"\"expert\"", "intermediate, skilled, unskilled"},
              [&] { findPerformer("expert", roots); });
}

}  // namespace
}  // namespace calot::recorder::performer_test
