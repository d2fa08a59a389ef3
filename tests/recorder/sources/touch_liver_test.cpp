// SPDX-License-Identifier: GPL-3.0-or-later
// The scene touch-liver held against what docs/reference/scenes.md says of it, in numbers; and real motion in it.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "recorder/formats/scene_file.h"
#include "recorder/sources/kinematics_source.h"
#include "recorder/sources/performer.h"
#include "recorder/sources/scene_surfaces.h"

namespace calot::recorder {
namespace {

namespace fs = std::filesystem;

const LoadedScene& touchLiver() {
  static const LoadedScene scene = loadScene(fs::path(CALOT_SOURCE_DIR) / "assets" / "scenes" / "touch-liver.json");
  return scene;
}

// Half the picture's height and width per metre of depth.
bool isInPicture(const SceneDescription& scene, const Vec3& p) {
  const Vec3 c = scene.camera.orientation.conjugate() * (p - scene.camera.position);
  const double tangent = std::tan(0.5 * scene.verticalFieldOfView);
  return c.z() > 0.0 && std::abs(c.y()) < tangent * c.z() && std::abs(c.x()) < tangent * 16.0 / 9.0 * c.z();
}

TEST(TouchLiver, isThePapersCaseB) {
  const SceneDescription& scene = touchLiver().description;
  ASSERT_EQ(scene.organs.size(), 2U);
  EXPECT_EQ(scene.organs[0].name, "liver");
  EXPECT_EQ(scene.organs[0].tetrahedra, 1489U);
  EXPECT_EQ(scene.organs[1].name, "gallbladder");
  EXPECT_EQ(scene.organs[1].tetrahedra, 121U);
  EXPECT_EQ(scene.ticksPerStep, 10U);
}

TEST(TouchLiver, portsHomesAndCameraAreClearOfTheOrgans) {
  const SceneDescription& scene = touchLiver().description;
  const SceneSurfaces surfaces(scene);
  for (const HandDescription& hand : scene.hands) {
    EXPECT_GT(surfaces.signedDistance(hand.port), 0.02);
    EXPECT_GT(surfaces.signedDistance(hand.home), 0.01);
    EXPECT_FALSE(surfaces.firstHit(hand.port, hand.home).has_value());
    EXPECT_TRUE(isInPicture(scene, hand.home));
  }
  EXPECT_GT(surfaces.signedDistance(scene.camera.position), 0.05);
}

TEST(TouchLiver, operatorsLeftIsTheLeftOfThePicture) {
  const SceneDescription& scene = touchLiver().description;
  const auto acrossPicture = [&](const Vec3& p) {
    return (scene.camera.orientation.conjugate() * (p - scene.camera.position)).x();
  };
  EXPECT_LT(acrossPicture(scene.hands[0].home), acrossPicture(scene.hands[1].home));
  EXPECT_LT(acrossPicture(scene.hands[0].port), acrossPicture(scene.hands[1].port));
  // The patient's right (+x) is the picture's left when one looks from the feet; the liver's larger lobe lies there.
  EXPECT_LT(acrossPicture(Vec3(0.05, 0, 0)), acrossPicture(Vec3(-0.05, 0, 0)));
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : scene.organs[0].surface.vertex) middle += p;
  EXPECT_GT(middle.x(), 0.0);
}

TEST(TouchLiver, cameraSeesBothOrgans) {
  const SceneDescription& scene = touchLiver().description;
  const SceneSurfaces surfaces(scene);
  for (std::size_t o = 0; o < scene.organs.size(); ++o) {
    const std::vector<Vec3>& vertex = scene.organs[o].surface.vertex;
    std::size_t shown = 0, inSight = 0;
    for (const Vec3& p : vertex) {
      if (!isInPicture(scene, p)) continue;
      ++shown;
      const auto hit = surfaces.firstHit(scene.camera.position, p);
      inSight += !hit || (hit->point - p).norm() < 1e-4 ? 1U : 0U;
    }
    EXPECT_GT(shown, vertex.size() * 8 / 10) << scene.organs[o].name;
    EXPECT_GT(inSight, vertex.size() * 15 / 100) << scene.organs[o].name;
  }
}

TEST(TouchLiver, anchorsHoldAPartOfEachOrganAndLeaveTheRest) {
  const SceneDescription& scene = touchLiver().description;
  const SceneSurfaces surfaces(scene);
  const auto held = [&](std::size_t o, const Vec3& p) {
    for (const AnchorDescription& a : scene.organs[o].anchors) {
      if (a.nearOrgan.empty() ? (p - a.centre).norm() <= a.radius
                              : std::abs(surfaces.signedDistance(0, p)) <= a.distance)
        return true;
    }
    return false;
  };
  for (std::size_t o = 0; o < 2; ++o) {
    std::size_t count = 0;
    const std::vector<Vec3>& vertex = scene.organs[o].surface.vertex;
    for (const Vec3& p : vertex) count += held(o, p) ? 1U : 0U;
    EXPECT_GT(count, vertex.size() / 20) << scene.organs[o].name;
    EXPECT_LT(count, vertex.size() / 2) << scene.organs[o].name;
  }
  // What instruments touch is free: the fundus and the liver's inferior border.
  const auto lowest = [&](std::size_t o) {
    Vec3 best(0, 0, 1);
    for (const Vec3& p : scene.organs[o].surface.vertex) {
      if (p.z() < best.z()) best = p;
    }
    return best;
  };
  EXPECT_FALSE(held(0, lowest(0)));
  EXPECT_FALSE(held(1, lowest(1)));
}

struct Touch {
  double seconds = 0.0;  // tip inside an organ at rest
  std::array<double, 2> organSeconds{};
  double deepest = 0.0;  // m
  double outside = 0.0;  // s outside the workspace
  std::uint64_t ticks = 0;
};

std::array<Touch, 2> play(SampleSource& source, const SceneDescription& scene) {
  const SceneSurfaces surfaces(scene);
  std::array<Touch, 2> touch;
  TickSamples samples;
  for (std::uint64_t tick = 0; source.next(tick, samples); ++tick) {
    for (std::size_t h = 0; h < 2; ++h) {
      Touch& t = touch[h];
      ++t.ticks;
      if (tick % 20 != 0) continue;
      const Vec3& p = samples.hand[h].position;
      for (std::size_t o = 0; o < 2; ++o) {
        const double distance = surfaces.signedDistance(o, p);
        if (distance >= 0.0) continue;
        t.organSeconds[o] += 0.02;
        t.deepest = std::max(t.deepest, -distance);
      }
      t.seconds = t.organSeconds[0] + t.organSeconds[1];
      if ((p.array() < scene.workspace[0].array()).any() || (p.array() > scene.workspace[1].array()).any())
        t.outside += 0.02;
    }
  }
  return touch;
}

TEST(TouchLiver, realMotionTouchesTheOrgansByMillimetres) {
  const fs::path data = fs::path(CALOT_SOURCE_DIR) / ".." / "shared" / "data" / "kinematics";
  std::error_code fault;
  std::vector<fs::path> files;
  for (fs::directory_iterator it(data, fault), end; !fault && it != end; ++it) {
    if (it->path().extension() == ".txt") files.push_back(it->path());
  }
  if (files.empty()) GTEST_SKIP() << "no kinematics files in ../shared/data/kinematics";
  const SceneDescription& scene = touchLiver().description;
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.filename().string());
    KinematicsSource source(file, scene);
    const std::array<Touch, 2> touch = play(source, scene);
    for (const Touch& t : touch) {
      EXPECT_GT(t.seconds, 0.5);
      EXPECT_GT(t.deepest, 0.0005);
      EXPECT_LT(t.deepest, 0.02);
      EXPECT_EQ(t.outside, 0.0);
      EXPECT_EQ(t.ticks, source.ticks());
    }
    const double liver = touch[0].organSeconds[0] + touch[1].organSeconds[0];
    const double gallbladder = touch[0].organSeconds[1] + touch[1].organSeconds[1];
    EXPECT_GT(liver, 1.0);
    EXPECT_GT(gallbladder, 1.0);
  }
}

TEST(TouchLiver, performersTouchBothOrgansWithBothHandsInTime) {
  const SceneDescription& scene = touchLiver().description;
  for (const char* name : {"skilled", "unskilled"}) {
    const PerformerProfile profile =
        loadPerformer(fs::path(CALOT_SOURCE_DIR) / "assets" / "performers" / (std::string(name) + ".json"));
    for (const std::uint64_t seed : {1U, 2U, 3U, 20140517U}) {
      SCOPED_TRACE(std::string(name) + " seed " + std::to_string(seed));
      PerformerSource source(profile, scene, seed);
      EXPECT_GE(source.ticks(), 12000U);
      EXPECT_LE(source.ticks(), 45000U);
      const std::array<Touch, 2> touch = play(source, scene);
      for (const Touch& t : touch) {
        EXPECT_GT(t.seconds, 1.0);
        EXPECT_LT(t.deepest, 0.025);
        EXPECT_EQ(t.outside, 0.0);
      }
      for (std::size_t o = 0; o < 2; ++o) EXPECT_GT(touch[0].organSeconds[o] + touch[1].organSeconds[o], 1.0);
    }
  }
}

}  // namespace
}  // namespace calot::recorder
