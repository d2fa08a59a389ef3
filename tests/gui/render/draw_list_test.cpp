// SPDX-License-Identifier: GPL-3.0-or-later
// What is kept from picture to picture may not be seen in any.
#include "gui/render/draw_list.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "gui/render/mesh.h"
#include "gui/render/renderer.h"
#include "sim/math/random.h"
#include "tests/gui/render/support/shapes.h"

namespace calot::gui::draw_list_test {
namespace {

using test::sphere;

constexpr std::uint64_t seed = 17;
/// All of a wide picture, without a round field.
Sight wide(const SceneView& view) { return sightOf(160, 90, view.verticalFieldOfView, false); }

/// Four triangles around a point.
std::vector<Index3> tetrahedron() { return {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}; }

bool sameList(const DrawList& a, const DrawList& b) {
  return a.index == b.index && a.vertex.size() == b.vertex.size() &&
         std::memcmp(a.vertex.data(), b.vertex.data(), a.vertex.size() * sizeof(DrawVertex)) == 0 &&
         a.part.size() == b.part.size() && a.referenceDistance == b.referenceDistance;
}

TEST(SurfaceForm, KnowsClosedSurfaces) {
  EXPECT_TRUE(isClosed(tetrahedron()));
  EXPECT_FALSE(isClosed({}));
  for (std::size_t missing = 0; missing < 4; ++missing) {
    std::vector<Index3> open = tetrahedron();
    open.erase(open.begin() + static_cast<std::ptrdiff_t>(missing));
    EXPECT_FALSE(isClosed(open));
    std::vector<Index3> turned = tetrahedron();
    std::swap(turned[missing][0], turned[missing][1]);
    EXPECT_FALSE(isClosed(turned)) << "one triangle inside out";
  }
  std::vector<Index3> two = tetrahedron();
  for (const Index3& t : tetrahedron()) two.push_back(t + Index3::Constant(4));
  EXPECT_TRUE(isClosed(two));
}

TEST(DrawListMaker, ForgetsNothingAndKeepsNothingWrong) {
  Random random(seed);
  DrawListMaker kept;
  SceneView view;
  view.surface = {sphere(Vec3(0.0, 0.0, 0.1), 0.03), sphere(Vec3(0.02, 0.0, 0.08), 0.01)};
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE("seed 17, round " + std::to_string(round));
    const std::uint32_t what = random.next() % 6;
    SurfaceView& surface = view.surface[random.next() % view.surface.size()];
    const std::size_t v = random.next() % surface.position.size();
    const double step = random.uniform(-0.002, 0.002);
    if (what == 0) surface.position[v].x() += step;
    if (what == 1) surface.rest[v].y() += step;
    if (what == 2 && surface.triangle.size() > 8) surface.triangle.pop_back();
    if (what == 3) surface = sphere(Vec3(step, 0.0, 0.09), 0.02, 8 + static_cast<int>(random.next() % 3));
    if (what == 4) surface.charred.assign(surface.position.size(), 0.0F);
    if (what == 4) surface.charred[v] = 0.7F;
    if (what == 5) view.camera.position.x() += step;
    DrawListMaker fresh;
    EXPECT_TRUE(sameList(kept.make(view, wide(view), true), fresh.make(view, wide(view), true)));
  }
}

/// Triangles go to the plain and to the harmed look, each to one of them.
TEST(DrawListMaker, SplitsWhatIsCharredFromWhatIsNot) {
  SceneView view;
  view.surface = {sphere(Vec3(0.0, 0.0, 0.1), 0.03)};
  SurfaceView& ball = view.surface[0];
  ball.charred.assign(ball.position.size(), 0.0F);
  ball.charred[100] = 0.5F;
  std::size_t around = 0;
  for (const Index3& t : ball.triangle) around += t[0] == 100 || t[1] == 100 || t[2] == 100 ? 1 : 0;
  DrawListMaker maker;
  const DrawList& list = maker.make(view, wide(view), false);
  ASSERT_EQ(list.part.size(), 2U);
  std::size_t harmed = 0, all = 0;
  for (const DrawPart& part : list.part) {
    all += part.indexCount;
    harmed += part.harmed ? part.indexCount : 0;
  }
  EXPECT_EQ(harmed, 3 * around);
  EXPECT_EQ(all, 3 * ball.triangle.size());
}

/// Of a closed body the far side is left out, and of any surface what lies beside the picture.
TEST(DrawListMaker, LeavesOutWhatTurnsAwayAndWhatIsBeside) {
  SceneView view;
  SurfaceView body;
  body.organ = body.appearance = "liver";
  body.position = {Vec3(0.0, 0.0, 0.08), Vec3(0.02, 0.0, 0.1), Vec3(-0.01, 0.02, 0.1), Vec3(-0.01, -0.02, 0.1)};
  body.rest = body.position;
  body.triangle = {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}};  // three sides of a pyramid, and its base behind them
  ASSERT_TRUE(isClosed(body.triangle));
  view.surface = {body};
  DrawListMaker maker;
  EXPECT_EQ(maker.make(view, wide(view), false).index.size(), 9U);
  view.surface[0].triangle.pop_back();  // open: both sides of what is left may be seen
  EXPECT_EQ(maker.make(view, wide(view), false).index.size(), 9U);
  view.surface[0].triangle = {{1, 2, 3}};
  EXPECT_EQ(maker.make(view, wide(view), false).index.size(), 3U);
  for (Vec3& p : view.surface[0].position) p.x() += 0.2;
  EXPECT_TRUE(maker.make(view, wide(view), false).index.empty());
}

/// Of the cavity only what the camera can see is drawn, and it is all that it can see.
TEST(DrawListMaker, LeavesOutOnlyTheCavityBesideThePicture) {
  Random random(seed, 1);
  DrawListMaker maker;
  SceneView view;
  view.surface = {sphere(Vec3(0.0, 0.0, 0.1), 0.03)};
  view.verticalFieldOfView = 0.9;
  const std::size_t whole = makeCavity(cavityShape(view)).triangle.size();
  Renderer renderer;
  for (int round = 0; round < 6; ++round) {
    const double angle = random.uniform(0.0, 6.0);
    const double x = random.uniform(-1.0, 1.0), y = random.uniform(-1.0, 1.0), z = random.uniform(-1.0, 1.0);
    view.camera.orientation = Quat(Eigen::AngleAxisd(angle, Vec3(x, y, z + 2.0).normalized()));
    const DrawList& list = maker.make(view, wide(view), true);
    ASSERT_EQ(list.part.back().appearance, Appearance::cavity);
    EXPECT_LT(list.part.back().indexCount, 3 * whole / 2);
    RenderSettings open;
    open.quality = Quality::interactive;
    open.endoscopeMask = false;
    const Image image = renderer.render(view, 160, 90, open);
    for (int py = 0; py < 90; ++py)
      for (int px = 0; px < 160; ++px) ASSERT_EQ(image.pixel(px, py)[3], 255) << "a hole at " << px << ", " << py;
  }
}

}  // namespace
}  // namespace calot::gui::draw_list_test
