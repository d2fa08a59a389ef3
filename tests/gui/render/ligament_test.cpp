// SPDX-License-Identifier: GPL-3.0-or-later
// The ligament behind the vessels hides none of them.
#include "gui/render/mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "gui/render/draw_list.h"
#include "tests/gui/render/support/shapes.h"

namespace calot::gui {
namespace {

/// Points of the wall of a straight vessel.
std::vector<Vec3> wall(const Vec3& from, const Vec3& to, double radius) {
  std::vector<Vec3> points;
  const Quat q = Quat::FromTwoVectors(Vec3::UnitZ(), to - from);
  for (int i = 0; i <= 60; ++i) {
    for (int k = 0; k < 12; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / 12;
      points.push_back(from + i / 60.0 * (to - from) +
                       q * Vec3(radius * std::cos(angle), radius * std::sin(angle), 0.0));
    }
  }
  return points;
}

/// Height of the mesh there; far below where it has no triangle.
double heightAt(const Mesh& mesh, double x, double z) {
  for (const Index3& t : mesh.triangle) {
    const Vec3 &a = mesh.position[static_cast<std::size_t>(t[0])], &b = mesh.position[static_cast<std::size_t>(t[1])],
               &c = mesh.position[static_cast<std::size_t>(t[2])];
    const double area = (b.x() - a.x()) * (c.z() - a.z()) - (c.x() - a.x()) * (b.z() - a.z());
    const double u = ((x - a.x()) * (c.z() - a.z()) - (c.x() - a.x()) * (z - a.z())) / area;
    const double v = ((b.x() - a.x()) * (z - a.z()) - (x - a.x()) * (b.z() - a.z())) / area;
    if (u >= -1e-9 && v >= -1e-9 && u + v <= 1.0 + 1e-9) return a.y() + u * (b.y() - a.y()) + v * (c.y() - a.y());
  }
  return -1.0;
}

/// A duct, and an artery that crosses 8 mm below it.
std::vector<Vec3> ductAndArtery() {
  std::vector<Vec3> points = wall({-0.045, -0.05, -0.06}, {-0.04, -0.04, 0.03}, 0.003);
  const std::vector<Vec3> artery = wall({-0.068, -0.055, -0.03}, {-0.02, -0.05, 0.01}, 0.0017);
  points.insert(points.end(), artery.begin(), artery.end());
  return points;
}

TEST(Ligament, LiesBelowEveryVessel) {
  const std::vector<Vec3> vessels = ductAndArtery();
  const Mesh mesh = makeLigament(vessels);
  for (const Vec3& p : vessels) EXPECT_LT(heightAt(mesh, p.x(), p.z()), p.y()) << p.transpose();
}

TEST(Ligament, IsCloseBehindThemAndFallsOffToTheSides) {
  const std::vector<Vec3> duct = wall({-0.045, -0.05, -0.06}, {-0.045, -0.05, 0.03}, 0.003);
  const Mesh mesh = makeLigament(duct);
  EXPECT_NEAR(heightAt(mesh, -0.045, -0.01), -0.0545, 0.002);
  EXPECT_LT(heightAt(mesh, -0.045 + 0.04, -0.01), -0.09);
  ASSERT_EQ(mesh.normal.size(), mesh.position.size());
  for (const Vec3& n : mesh.normal) EXPECT_GT(n.y(), 0.0) << "seen from above";
}

TEST(Ligament, WithoutVesselsThereIsNone) { EXPECT_TRUE(makeLigament({}).position.empty()); }

TEST(Ligament, StandsStillWhileVesselsMove) {
  SceneView view;
  view.verticalFieldOfView = 0.9;
  view.surface.push_back(test::sphere(Vec3(0.0, 0.0, 0.12), 0.02, 16, "duct"));
  view.surface.front().role = StructureRole::bileDuct;
  DrawListMaker maker;
  const Sight sight = sightOf(320, 240, view.verticalFieldOfView, true);
  const auto cavityIndices = [&] {
    std::size_t indices = 0;
    for (const DrawPart& part : maker.make(view, sight, true, {}).part)
      indices += part.appearance == Appearance::cavity ? part.indexCount : 0;
    return indices;
  };
  const std::size_t with = cavityIndices();
  for (Vec3& p : view.surface.front().position) p += Vec3(0.002, 0.0, 0.0);
  EXPECT_EQ(cavityIndices(), with);
  view.surface.front().role = StructureRole::cysticDuct;
  EXPECT_LT(cavityIndices(), with) << "what is to be divided lies in no ligament";
}

}  // namespace
}  // namespace calot::gui
