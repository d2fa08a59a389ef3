// SPDX-License-Identifier: GPL-3.0-or-later
// What an open vessel leaves in the picture.
#include "gui/render/draw_list.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "gui/render/renderer.h"
#include "sim/math/random.h"
#include "tests/gui/render/support/shapes.h"

namespace calot::gui::ooze_test {
namespace {

constexpr std::uint64_t seed = 23;
constexpr int sides = 16;
constexpr double radius = 0.002;

/// The face of a stump: a disk that looks along x.
SurfaceView stump(StructureRole role, float middle) {
  SurfaceView surface;
  surface.organ = "vessel";
  surface.appearance = carriesBile(role) ? "duct" : "artery";
  surface.role = role;
  surface.position.emplace_back(0.01, 0.0, 0.0);
  surface.face.push_back(middle);
  for (int k = 0; k < sides; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / sides;
    surface.position.emplace_back(0.01, radius * std::cos(angle), radius * std::sin(angle));
    surface.face.push_back(1.0F);
    surface.triangle.emplace_back(0, 1 + k, 1 + (k + 1) % sides);
  }
  surface.rest = surface.position;
  return surface;
}

double volume(const Mesh& mesh) { return test::volume(mesh.position, mesh.triangle); }

double lowest(const Mesh& mesh) {
  double z = 1e9;
  for (const Vec3& p : mesh.position) z = std::min(z, p.z());
  return z;
}

TEST(Ooze, KnowsOpenFacesByTheirMiddles) {
  SceneView view;
  view.surface = {stump(StructureRole::cysticArtery, 2.0F), stump(StructureRole::cysticDuct, 2.0F),
                  stump(StructureRole::cysticArtery, 1.5F), stump(StructureRole::bileDuct, 2.0F)};
  const std::vector<OpenEnd> ends = openEnds(view);
  ASSERT_EQ(ends.size(), 3U) << "a clip shuts the third one";
  EXPECT_FALSE(ends[0].bile);
  EXPECT_TRUE(ends[1].bile);
  EXPECT_TRUE(ends[2].bile);
  EXPECT_LT((ends[0].position - Vec3(0.01, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((ends[0].outwards - Vec3::UnitX()).norm(), 1e-12);
  // A regular polygon has n / (2 pi) sin(2 pi / n) of the area of its circle.
  const double share = sides / (2.0 * std::numbers::pi) * std::sin(2.0 * std::numbers::pi / sides);
  EXPECT_NEAR(ends[0].radius, radius * std::sqrt(share), 1e-12);
}

TEST(Ooze, ADropSwellsHangsAndFalls) {
  const OpenEnd end{Vec3::Zero(), Vec3::UnitX(), radius};
  double before = 0.0;
  for (const double time : {0.0, 1.0, 2.0, 3.0, 3.8}) {
    const Mesh drop = makeDrop(end, time);
    EXPECT_GT(volume(drop), before) << time << " s: its skin looks outwards, and it grows";
    EXPECT_LT(lowest(drop), -0.6 * radius) << "it hangs below the middle of the face";
    EXPECT_GT(lowest(drop), -4.0 * radius);
    before = volume(drop);
  }
  EXPECT_LT(lowest(makeDrop(end, 3.999)), -0.03) << "it falls";
  EXPECT_NEAR(volume(makeDrop(end, 4.5)), volume(makeDrop(end, 0.5)), 1e-15) << "and begins anew";
}

TEST(Ooze, StainsWhatIsBelowAndNothingElse) {
  RecordProperty("seed", static_cast<int>(seed));
  Random random(seed);
  const OpenEnd end{Vec3(0.1, -0.2, 0.3), Vec3::UnitX(), radius};
  int stained = 0;
  for (int n = 0; n < 2000; ++n) {
    const double x = random.uniform(-0.03, 0.03);
    const double y = random.uniform(-0.03, 0.03);
    const double z = random.uniform(-0.08, 0.03);
    const double stain = stainAt(end, end.position + Vec3(x, y, z), 0.1 * n);
    EXPECT_GE(stain, 0.0);
    EXPECT_LE(stain, 1.0);
    if (stain > 0.0) {
      ++stained;
      EXPECT_LT(z, 0.0021);
      EXPECT_LT(std::hypot(x, y), 0.02);
    }
  }
  EXPECT_GT(stained, 20);
  double least = 1.0, most = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double stain = stainAt(end, end.position - Vec3(0.0, 0.0, 0.01), 0.01 * i);
    least = std::min(least, stain);
    most = std::max(most, stain);
  }
  EXPECT_NEAR(most, 1.0, 0.01) << "right below";
  EXPECT_GT(least, 0.7) << "it is never clean there";
  EXPECT_LT(least, 0.9) << "it runs";
}

/// Of a scene whose gravity is not along z.
TEST(Ooze, FallsAndRunsWhereGravityPulls) {
  SceneView view;
  view.surface = {stump(StructureRole::cysticArtery, 2.0F)};
  view.down = Vec3(0.0, -0.94, -0.34).normalized();
  const OpenEnd end = openEnds(view).at(0);
  EXPECT_EQ(end.down, view.down);
  const auto middle = [&](double time) {
    Vec3 sum = Vec3::Zero();
    const Mesh drop = makeDrop(end, time);
    for (const Vec3& p : drop.position) sum += p;
    return Vec3(sum / static_cast<double>(drop.position.size()));
  };
  const Vec3 fallen = middle(3.999) - middle(3.9);
  EXPECT_GT(fallen.norm(), 0.03);
  EXPECT_GT(fallen.normalized().dot(view.down), 0.999);
  EXPECT_GT(stainAt(end, end.position + 0.01 * view.down, 0.0), 0.5);
  EXPECT_EQ(stainAt(end, end.position - 0.01 * Vec3::UnitZ(), 0.0), 0.0) << "beside it";
}

/// A stump over a liver that slopes away below it, seen from the side.
class OozePicture : public testing::Test {
 protected:
  static SceneView scene(StructureRole vessel, float middle) {
    SceneView view;
    view.verticalFieldOfView = 0.5;
    // x of C is y of W to the left, y of C is down, z of C looks along -x.
    Mat3 axes;
    axes.col(0) = Vec3::UnitY();
    axes.col(1) = -Vec3::UnitZ();
    axes.col(2) = -Vec3::UnitX();
    view.camera.orientation = Quat(axes);
    view.camera.position = Vec3(0.11, 0.0, -0.008);
    view.down = -Vec3::UnitZ();
    const SurfaceView liver =
        test::sheetOver("liver", 30, [](double u, double v) { return Vec3(0.009 - 0.01 * v, 0.1 * u, -0.1 * v); });
    view.surface = {liver, stump(vessel, middle)};
    return view;
  }
  /// Mean of red, green and blue 10 mm below the face, where no drop hangs.
  static std::array<double, 3> below(const SceneView& view, Quality quality) {
    static Renderer renderer;
    const RenderSettings bare{quality, false, false};
    const Image image = renderer.render(view, 200, 200, bare);
    const double f = 100.0 / std::tan(0.25);
    const int y = static_cast<int>(100.0 + f * (0.006 + 0.004 - 0.008) / 0.105);
    std::array<double, 3> sum{};
    for (int dy = -6; dy <= 6; ++dy)
      for (int x = 92; x < 108; ++x)
        for (std::size_t c = 0; c < 3; ++c) sum[c] += image.pixel(x, y + dy)[c] / (13.0 * 16.0);
    return sum;
  }
};

TEST_F(OozePicture, BloodRunsOverWhatIsBelowAnOpenArtery) {
  for (const Quality quality : {Quality::interactive, Quality::film}) {
    const auto clean = below(scene(StructureRole::artery, 1.5F), quality);
    const auto bloody = below(scene(StructureRole::artery, 2.0F), quality);
    EXPECT_GT(bloody[0] / bloody[1], 1.25 * clean[0] / clean[1]) << "redder than liver";
  }
}

TEST_F(OozePicture, BileIsNotRed) {
  const auto clean = below(scene(StructureRole::bileDuct, 1.5F), Quality::film);
  const auto bile = below(scene(StructureRole::bileDuct, 2.0F), Quality::film);
  EXPECT_LT(bile[0] / bile[1], 0.8 * clean[0] / clean[1]);
}

TEST_F(OozePicture, TheSameViewGivesTheSameBytesAndAnotherTimeAnotherDrop) {
  Renderer renderer;
  SceneView view = scene(StructureRole::artery, 2.0F);
  const Image first = renderer.render(view, 200, 200, Quality::interactive);
  EXPECT_EQ(first.rgba, renderer.render(view, 200, 200, Quality::interactive).rgba);
  view.time = 3.0;
  EXPECT_NE(first.rgba, renderer.render(view, 200, 200, Quality::interactive).rgba);
}

}  // namespace
}  // namespace calot::gui::ooze_test
