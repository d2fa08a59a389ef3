// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/recorder/sources/support/test_scene.h"

#include <cmath>
#include <map>
#include <utility>

#include "recorder/sources/pointing.h"

namespace calot::test {

SurfaceDescription sphereSurface(const Vec3& centre, double radius, int levels) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  SurfaceDescription s;
  s.vertex = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
              {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  s.triangle = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middle;
    const auto between = [&](int a, int b) {
      const auto [found, added] = middle.emplace(std::minmax(a, b), static_cast<int>(s.vertex.size()));
      if (added) s.vertex.push_back(s.vertex[static_cast<std::size_t>(a)] + s.vertex[static_cast<std::size_t>(b)]);
      return found->second;
    };
    std::vector<Index3> finer;
    for (const Index3& t : s.triangle) {
      const int a = between(t[0], t[1]), b = between(t[1], t[2]), c = between(t[2], t[0]);
      finer.insert(finer.end(), {Index3(t[0], a, c), Index3(t[1], b, a), Index3(t[2], c, b), Index3(a, b, c)});
    }
    s.triangle = finer;
    for (Vec3& v : s.vertex) v.normalize();
  }
  for (Vec3& v : s.vertex) v = centre + radius * v.normalized();
  return s;
}

SceneDescription roundScene() {
  SceneDescription scene;
  scene.name = "round";
  scene.workspace = {Vec3(-0.12, -0.12, -0.12), Vec3(0.12, 0.12, 0.12)};
  OrganDescription liver;
  liver.name = "liver";
  liver.surface = sphereSurface(Vec3(0.0, 0.0, 0.06), 0.05, 3);
  OrganDescription gallbladder;
  gallbladder.name = "gallbladder";
  gallbladder.surface = sphereSurface(Vec3(0.04, 0.0, 0.0), 0.015, 2);
  scene.organs = {liver, gallbladder};
  scene.hands[0].port = Vec3(-0.10, 0.08, -0.06);
  scene.hands[1].port = Vec3(0.10, 0.08, -0.06);
  scene.hands[0].home = Vec3(-0.03, 0.02, -0.03);
  scene.hands[1].home = Vec3(0.06, 0.03, -0.04);
  scene.camera.position = Vec3(0.0, 0.0, -0.12);
  Mat3 axes;  // x right, y down, z along the view (+z of W)
  axes << -1, 0, 0, 0, -1, 0, 0, 0, 1;
  scene.camera.orientation = recorder::quaternionOf(axes);
  scene.verticalFieldOfView = 1.0;
  return scene;
}

}  // namespace calot::test
