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

}  // namespace
}  // namespace calot::gui
