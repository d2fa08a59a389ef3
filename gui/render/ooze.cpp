// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/ooze.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "gui/render/mesh.h"

namespace calot::gui {
namespace {

constexpr double period = 4.0;                      // s from drop to drop
constexpr double falling = 0.09;                    // s that a drop is seen falling
constexpr double smallest = 0.45, largest = 0.85;   // radius of a drop over the vessel's
constexpr double gravity = 9.81;                    // m/s^2
constexpr double narrow = 0.0030, wider = 0.16;     // half width of the stain at the face (m), and more per m below
constexpr double above = 0.0020, farthest = 0.045;  // m above and below the face that it reaches
constexpr double wave = 0.013, speed = 0.009;       // from wave to wave of what runs (m), and how fast they are (m/s)
constexpr double fresh = 0.22;                      // share of the stain that comes and goes with them

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Pointed above, round below.
Mesh drop(double radius) {
  constexpr int rings = 10, around = 14;
  std::vector<Ring> skin;
  for (int i = 0; i < rings; ++i) {
    const double angle = std::numbers::pi * (i + 0.4) / (rings - 0.2);
    const double z = -radius * std::cos(angle) * (angle > 0.5 * std::numbers::pi ? 1.6 : 1.0);
    const double across = radius * std::sin(angle) * (1.0 - 0.28 * std::max(0.0, -std::cos(angle)));
    skin.push_back(superellipse(Vec3(0.0, 0.0, z), across, across, 2.0, around));
  }
  return loft(skin);
}

}  // namespace

std::vector<OpenEnd> openEnds(const SceneView& view) {
  std::vector<OpenEnd> ends;
  for (const SurfaceView& surface : view.surface) {
    const auto middleOf = [&](const Index3& t) {
      for (int a = 0; a < 3; ++a)
        if (surface.face[at(t[a])] >= 2.0F) return t[a];
      return -1;
    };
    std::map<int, Vec3> areas;  // twice that of the triangles around a vertex in the middle
    if (!surface.face.empty())
      for (const Index3& t : surface.triangle)
        if (const int middle = middleOf(t); middle >= 0) {
          const auto p = [&](int corner) { return surface.position[at(t[corner])]; };
          areas.try_emplace(middle, Vec3::Zero()).first->second += (p(1) - p(0)).cross(p(2) - p(0));
        }
    for (const auto& [middle, area] : areas) {
      if (!(area.norm() > 0.0)) continue;
      const double radius = std::sqrt(0.5 * area.norm() / std::numbers::pi);
      ends.push_back({surface.position[at(middle)], area.normalized(), radius, view.down, carriesBile(surface.role)});
    }
  }
  return ends;
}

Mesh makeDrop(const OpenEnd& end, double time) {
  const double age = time - period * std::floor(time / period);
  const double hanging = period - falling;
  const double share = std::min(1.0, age / hanging);
  const double radius = end.radius * (smallest + (largest - smallest) * share);
  const double fallen = age > hanging ? 0.5 * gravity * (age - hanging) * (age - hanging) : 0.0;
  return moved(drop(radius), upright(end.down), 0.35 * end.radius * end.outwards + (0.7 * radius + fallen) * end.down);
}

double stainAt(const OpenEnd& end, const Vec3& p_W, double time) {
  const Vec3 d = upright(end.down).conjugate() * (p_W - end.position);
  const double below = -d.z();
  if (below < -above || below > farthest) return 0.0;
  const double aside = std::hypot(d.x(), d.y());
  const double around = std::atan2(d.y(), d.x());
  // Uneven, as what runs over tissue is.
  const double uneven = 1.0 + 0.25 * std::sin(3.0 * around + 260.0 * below) + 0.15 * std::sin(5.0 * around + 1.7);
  const double width = (end.radius + narrow + wider * std::max(below, 0.0)) * uneven;
  if (aside >= width) return 0.0;
  const double inside = 1.0 - aside / width;
  const double ends =
      std::clamp((farthest - below) / (0.4 * farthest), 0.0, 1.0) * std::clamp((below + above) / above, 0.0, 1.0);
  const double runs = 0.5 + 0.5 * std::sin(2.0 * std::numbers::pi * (below - speed * time) / wave);
  return std::min(1.0, 1.8 * inside) * ends * (1.0 - fresh * runs);
}

}  // namespace calot::gui
