// SPDX-License-Identifier: GPL-3.0-or-later
// From State to view: fat that is carved from frame to frame, vessels that are cut and clipped.
#include "sim/scene/scene_viewer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "sim/fat/fat_body.h"
#include "sim/vessel/beam_state.h"
#include "tests/gui/render/support/shapes.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr double fatTop = test::blockTop + 0.010;

SceneDescription padScene() {
  SceneDescription scene = test::blockScene(300, 6);
  VesselDescription duct;
  duct.name = "duct";
  duct.appearance = "duct";
  duct.role = StructureRole::cysticDuct;
  duct.path = {Vec3(-0.025, 0.0, test::blockTop + 0.005), Vec3(0.025, 0.0, test::blockTop + 0.005)};
  duct.material = {2e5, 0.45, 1050.0, 5.0, 0.01};
  duct.start.kind = duct.end.kind = VesselEndDescription::Kind::fixed;
  scene.vessels.push_back(duct);
  FatDescription fat;
  fat.name = "pad";
  fat.appearance = "fat";
  fat.surface = test::boxSurface(Vec3(-0.012, -0.010, test::blockTop + 0.0002), Vec3(0.012, 0.010, fatTop), {8, 8, 4});
  fat.cellSize = 0.001;
  fat.attachments = {{"block", 0.0015, 2e7, 2e5}, {"duct", 0.001, 2e7, 2e5}};
  scene.fat.push_back(fat);
  return scene;
}

class Viewer : public testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::buildModel(padScene()); }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override { ASSERT_TRUE(model_); }

  static void groove(State& state, double y) {
    FatBody body(*model_->fat()[0]);
    ASSERT_TRUE(body.rebuild(state.fat[0]));
    body.beginStep(state.fat[0]);
    const SweptCapsule hook{Vec3(-0.016, y, fatTop), Vec3(-0.016, y, fatTop - 0.002), Vec3(0.016, y, fatTop),
                            Vec3(0.016, y, fatTop - 0.002), 0.001};
    ASSERT_TRUE(body.stroke(state.fat[0], std::span(&hook, 1)).changed);
  }
  static const SurfaceView& named(const SceneView& view, const std::string& name) {
    return *std::find_if(view.surface.begin(), view.surface.end(), [&](const auto& s) { return s.organ == name; });
  }
  static void expectSame(const SceneView& a, const SceneView& b) {
    ASSERT_EQ(a.surface.size(), b.surface.size());
    for (std::size_t s = 0; s < a.surface.size(); ++s) {
      EXPECT_EQ(a.surface[s].position, b.surface[s].position) << a.surface[s].organ;
      EXPECT_EQ(a.surface[s].rest, b.surface[s].rest);
      EXPECT_EQ(a.surface[s].triangle, b.surface[s].triangle);
      EXPECT_EQ(a.surface[s].charred, b.surface[s].charred);
      EXPECT_EQ(a.surface[s].face, b.surface[s].face);
    }
  }
  /// Every side of a triangle belongs to one other, the other way round.
  static bool closed(const SurfaceView& surface) {
    std::map<std::pair<int, int>, int> sides;
    for (const Index3& t : surface.triangle)
      for (int k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
    return std::all_of(sides.begin(), sides.end(), [&](const auto& side) {
      const auto other = sides.find({side.first.second, side.first.first});
      return side.second == 1 && other != sides.end();
    });
  }
  static double volume(const SurfaceView& surface) { return gui::test::volume(surface.position, surface.triangle); }

  static inline std::unique_ptr<const Model> model_;
};

/// Forward, backward, again: as if each State had been met first.
TEST_F(Viewer, FollowsCarvingBothWays) {
  SceneViewer viewer(*model_);
  const State rest = initialState(*model_, 1);
  State once = rest;
  groove(once, 0.004);
  State twice = once;
  groove(twice, -0.004);
  for (const State* state : std::initializer_list<const State*>{&rest, &once, &once, &twice, &rest, &twice})
    expectSame(viewer.view(*state), viewOf(*model_, *state));
}

TEST_F(Viewer, FatIsAClosedSurfaceAndSearedWhereItWasCarved) {
  const State rest = initialState(*model_, 1);
  State carved = rest;
  groove(carved, 0.004);
  const SceneView before = viewOf(*model_, rest), after = viewOf(*model_, carved);
  const SurfaceView& fat = named(after, "pad");
  EXPECT_EQ(fat.appearance, "fat");
  EXPECT_EQ(fat.role, StructureRole::other);
  EXPECT_EQ(named(after, "duct").role, StructureRole::cysticDuct);
  EXPECT_TRUE(closed(named(before, "pad")));
  EXPECT_TRUE(closed(fat));
  EXPECT_GT(volume(fat), 0.0);
  EXPECT_LT(volume(fat), volume(named(before, "pad")) - 30e-9);
  EXPECT_TRUE(named(before, "pad").charred.empty());
  ASSERT_EQ(fat.charred.size(), fat.position.size());
  std::size_t seared = 0;
  for (std::size_t v = 0; v < fat.rest.size(); ++v) {
    const bool inGroove = std::abs(fat.rest[v].y() - 0.004) < 0.0025 && fat.rest[v].z() > fatTop - 0.0045;
    if (!inGroove) {
      EXPECT_LT(fat.charred[v], 0.05F);
    }
    if (fat.charred[v] > 0.2F) ++seared;
  }
  EXPECT_GT(seared, 20U);
}

TEST_F(Viewer, FatGoesWithItsSolid) {
  SceneViewer viewer(*model_);
  State state = initialState(*model_, 1);
  const SurfaceView before = named(viewer.view(state), "pad");
  const Vec3 shift(0.001, -0.002, 0.003);
  for (Vec3& p : state.fat[0].solid.position) p += shift;
  const SurfaceView after = named(viewer.view(state), "pad");
  EXPECT_EQ(after.rest, before.rest);
  for (std::size_t v = 0; v < after.position.size(); ++v)
    ASSERT_LT((after.position[v] - before.position[v] - shift).norm(), 1e-12);
}

TEST_F(Viewer, ACutHasTwoFacesAndAVesselThatIsWholeHasNone) {
  State state = initialState(*model_, 1);
  const SceneView whole = viewOf(*model_, state);
  EXPECT_TRUE(closed(named(whole, "duct")));
  EXPECT_TRUE(named(whole, "duct").face.empty());
  EXPECT_TRUE(named(whole, "duct").charred.empty());
  const BeamModel& beams = model_->vesselTrees()[0].beams;
  const BeamPoint where = pointAt(beams, 0, 0.020);
  ASSERT_TRUE(part(state.vessel[0], where, Parting::cut));
  const SceneView view = viewOf(*model_, state);
  const SurfaceView& cut = named(view, "duct");
  ASSERT_EQ(cut.face.size(), cut.position.size());
  EXPECT_EQ(std::count(cut.face.begin(), cut.face.end(), 2.0F), 2);
  EXPECT_EQ(std::count(cut.face.begin(), cut.face.end(), 1.0F), 24);
  for (std::size_t v = 0; v < cut.face.size(); ++v) {
    const double away = std::abs(cut.rest[v].x() + 0.005);
    if (cut.face[v] >= 1.0F) {
      EXPECT_LT(away, 0.0002);
    }
    if (away > 0.002) {
      EXPECT_EQ(cut.face[v], 0.0F);
    }
  }
  for (const Index3& t : cut.triangle) {
    EXPECT_GE(t.minCoeff(), 0);
    EXPECT_LT(t.maxCoeff(), static_cast<int>(cut.position.size()));
  }
}

TEST_F(Viewer, ClipsSitOnTheirVesselWithTheCrotchTowardsThePorts) {
  State state = initialState(*model_, 1);
  const BeamModel& beams = model_->vesselTrees()[0].beams;
  for (const double roll : {0.3, 0.3 + 3.14159265358979}) {
    ClipAttempt attempt;
    attempt.point = pointAt(beams, 0, 0.035);
    attempt.width = 0.0012;
    attempt.legs = 0.0085;
    attempt.roll = roll;
    setClip(beams, state.vessel[0], attempt, 1.0);
  }
  const SceneView view = viewOf(*model_, state);
  ASSERT_EQ(view.clip.size(), 2U);
  for (const ClipView& clip : view.clip) {
    EXPECT_LT((clip.pose.position - Vec3(0.010, 0.0, test::blockTop + 0.005)).norm(), 1e-4);
    EXPECT_GT(std::abs((clip.pose.orientation * Vec3::UnitZ()).x()), 0.999);
    EXPECT_LT((clip.pose.orientation * Vec3::UnitY()).z(), 0.0) << "the ports are above";
  }
}

TEST_F(Viewer, CauteryBlendsAlongAVessel) {
  State state = initialState(*model_, 1);
  const BeamModel::Branch& branch = model_->vesselTrees()[0].beams.branches()[0];
  const std::size_t middle = branch.firstStation + branch.stations / 2;
  // Most in the middle, half of it 2 mm beside.
  for (std::size_t s = 0; s < branch.stations; ++s) {
    const double off = (static_cast<double>(branch.firstStation + s) - static_cast<double>(middle)) * branch.spacing();
    const double share = std::max(0.0, 1.0 - std::abs(off) / 0.004);
    state.vessel[0].exposure[branch.firstStation + s] = share * model_->scene().vessels[0].burnThrough;
  }
  const SceneView view = viewOf(*model_, state);
  const SurfaceView& duct = named(view, "duct");
  ASSERT_EQ(duct.charred.size(), duct.position.size());
  const float most = *std::max_element(duct.charred.begin(), duct.charred.end());
  EXPECT_GT(most, 0.8F);
  EXPECT_LE(most, 1.0F);
  EXPECT_GT(std::count_if(duct.charred.begin(), duct.charred.end(), [](float c) { return c > 0.2F && c < 0.8F; }), 16);
}

/// Of a cut's two faces the one that no clip closes is open: 2 in its middle, the other one less.
TEST_F(Viewer, AFaceIsOpenUntilAClipClosesItsSide) {
  const auto middles = [](const State& state) {
    const SceneView view = viewOf(*model_, state);
    std::vector<float> found;
    for (const float value : named(view, "duct").face)
      if (value > 1.0F) found.push_back(value);
    return found;
  };
  State state = initialState(*model_, 1);
  EXPECT_TRUE(middles(state).empty());
  const BeamModel& beams = model_->vesselTrees()[0].beams;
  ASSERT_TRUE(part(state.vessel[0], pointAt(beams, 0, 0.025), Parting::cut));
  EXPECT_EQ(middles(state), (std::vector<float>{2.0F, 2.0F}));
  ClipAttempt clip;
  clip.point = pointAt(beams, 0, 0.018);
  clip.width = 0.0015;
  clip.legs = 0.0085;
  clip.depth = 0.004;
  setClip(beams, state.vessel[0], clip, 1.0);
  EXPECT_EQ(middles(state), (std::vector<float>{1.5F, 2.0F}));
  clip.point = pointAt(beams, 0, 0.032);
  clip.closure = 0.5;  // it does not shut
  setClip(beams, state.vessel[0], clip, 1.0);
  EXPECT_EQ(middles(state), (std::vector<float>{1.5F, 2.0F}));
}

}  // namespace
}  // namespace calot
