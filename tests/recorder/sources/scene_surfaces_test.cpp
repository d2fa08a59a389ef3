// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/scene_surfaces.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <random>

#include "recorder/formats/scene_file.h"
#include "sim/geometry/closest_point.h"

namespace calot::recorder {
namespace {

/// Every triangle, in order.
std::optional<SceneSurfaces::Hit> hitByAll(const SceneSurfaces& surfaces, const Vec3& a, const Vec3& b) {
  std::optional<SceneSurfaces::Hit> best;
  for (std::size_t o = 0; o < surfaces.organs(); ++o) {
    const TriangleMesh& mesh = surfaces.mesh(o);
    for (int t = 0; t < mesh.triangles(); ++t) {
      const SegmentTriangle r = closestSegmentTriangle(a, b, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
      if (r.crosses && (!best || r.parameter < best->parameter))
        best = SceneSurfaces::Hit{o, r.parameter, r.onTriangle};
    }
  }
  return best;
}

TEST(SceneSurfaces, TheFirstHitIsThatOfAllTriangles) {
  const LoadedScene scene =
      loadScene(std::filesystem::path(CALOT_SOURCE_DIR) / "assets" / "scenes" / "touch-liver.json");
  const SceneSurfaces surfaces(scene.description);
  std::mt19937 random(5);
  const auto coordinate = [&] { return -0.15 + 0.3 * static_cast<double>(random()) / 4294967296.0; };
  int hits = 0;
  for (int i = 0; i < 400; ++i) {
    Vec3 a(coordinate(), coordinate(), coordinate());
    Vec3 b(coordinate(), coordinate(), coordinate());
    if (i % 4 == 0) b = Vec3(a[0], a[1], b[2]);                                    // along an axis
    if (i % 5 == 0) b = surfaces.mesh(0).vertex[static_cast<std::size_t>(7 * i)];  // to a corner
    const auto expected = hitByAll(surfaces, a, b);
    const auto found = surfaces.firstHit(a, b);
    ASSERT_EQ(found.has_value(), expected.has_value()) << i;
    if (!found) continue;
    ++hits;
    EXPECT_EQ(found->organ, expected->organ);
    EXPECT_EQ(found->parameter, expected->parameter);  // bit for bit
    EXPECT_EQ(found->point, expected->point);
  }
  EXPECT_GT(hits, 40);
}

}  // namespace
}  // namespace calot::recorder
