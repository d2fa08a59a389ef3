// SPDX-License-Identifier: GPL-3.0-or-later
// Omentum and bowel hide nothing that is operated on.
#include "gui/render/mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/gui/render/support/shapes.h"

namespace calot::gui {
namespace {

const std::vector<Vec3> hilum{Vec3(-0.05, -0.056, -0.08), Vec3(-0.04, -0.04, 0.05)};

TEST(Viscera, LieBelowWhatMayNotBeHidden) {
  for (const double lowest : {-0.06, -0.02, 0.01}) {
    const Viscera viscera = makeViscera(hilum, lowest);
    double top = -1.0;
    for (const Mesh* const mesh : {&viscera.omentum, &viscera.bowel})
      for (const Vec3& p : mesh->position) top = std::max(top, p.y());
    EXPECT_LT(top, lowest - 0.001);
    EXPECT_GT(top, lowest - 0.004) << "as high as they may";
  }
}

TEST(Viscera, AreAnApronSeenFromAboveAndClosedTubes) {
  const Viscera viscera = makeViscera(hilum, -0.06);
  for (const Vec3& n : viscera.omentum.normal) EXPECT_GT(n.y(), 0.0);
  EXPECT_GT(test::volume(viscera.bowel.position, viscera.bowel.triangle), 1e-4) << "their skin looks outwards";
  double above = 0.0;
  for (const Vec3& p : viscera.bowel.position) above = std::max(above, p.y() - (-0.06 - 0.002 - 0.011));
  EXPECT_GT(above, 0.008) << "the bowel rises over the apron";
  const std::size_t middle = viscera.omentum.position.size() / 2;
  EXPECT_GT(viscera.omentum.position[middle].y(), viscera.omentum.position.front().y()) << "its border has sunk";
}

TEST(Viscera, WithoutAHilumThereAreNone) {
  EXPECT_TRUE(makeViscera({}, -0.06).omentum.position.empty());
  EXPECT_TRUE(makeViscera({}, -0.06).bowel.position.empty());
}

/// The liver's border may lie in them, the gallbladder not; they are made once.
TEST(Surroundings, KeepWhatTheOrgansAtRestDoNotChange) {
  SceneView view;
  view.surface = {test::sphere(Vec3(0.0, -0.1, 0.12), 0.02, 16, "liver"),
                  test::sphere(Vec3(0.0, 0.0, 0.12), 0.02, 16, "gallbladder"),
                  test::sphere(Vec3(-0.05, 0.0, 0.12), 0.01, 16, "duct")};
  view.surface[0].role = StructureRole::liver;
  view.surface[1].role = StructureRole::gallbladder;
  view.surface[2].role = StructureRole::bileDuct;
  Surroundings around;
  around.update(view);
  double top = -1.0;
  for (const Vec3& p : around.viscera.bowel.position) top = std::max(top, p.y());
  EXPECT_NEAR(top, -0.022, 0.001);
  const Vec3* const kept = around.viscera.omentum.position.data();
  for (SurfaceView& surface : view.surface)
    for (Vec3& p : surface.position) p += Vec3(0.0, -0.03, 0.0);
  around.update(view);
  EXPECT_EQ(around.viscera.omentum.position.data(), kept);
  view.down = -Vec3::UnitZ();
  around.update(view);
  EXPECT_TRUE(around.viscera.omentum.position.empty()) << "y is not up";
  EXPECT_TRUE(around.ligament.position.empty());
  view.down = -Vec3::UnitY();
  view.surface.pop_back();
  around.update(view);
  EXPECT_TRUE(around.viscera.omentum.position.empty());
  EXPECT_FALSE(around.wall.position.empty());
}

TEST(Surroundings, StopAClipThatWasLost) {
  Surroundings around;
  around.viscera = makeViscera(hilum, -0.06);
  const Vec3 down = -Vec3::UnitY();
  const Mesh& omentum = around.viscera.omentum;
  const Vec3 under = omentum.position[omentum.position.size() / 2];
  ClipView clip;
  clip.width = 0.0012;
  clip.pose.position = under + 0.02 * down;
  const Pose rest = around.restOf(clip, down);
  EXPECT_NEAR(rest.position.y(), under.y(), 0.02) << "on it, or on the bowel over it";
  EXPECT_GT(rest.position.y(), clip.pose.position.y());
  EXPECT_LT((rest.position - clip.pose.position).cross(down).norm(), 0.001) << "straight above";
  const Vec3 up = rest.orientation * Vec3::UnitZ();
  EXPECT_GT(up.y(), 0.3) << "flat on what it lies on";
  clip.pose.position = under - 0.05 * down;
  EXPECT_EQ(around.restOf(clip, down).position, clip.pose.position) << "still falling";
  clip.pose.position = under + Vec3(2.0, -0.02, 0.0);
  EXPECT_EQ(around.restOf(clip, down).position, clip.pose.position) << "beside it";
}

}  // namespace
}  // namespace calot::gui
