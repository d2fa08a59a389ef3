// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/ground.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace calot {
namespace {

/// How far along a ray from p it meets a triangle (Moeller and Trumbore 1997), or nothing.
std::optional<double> meet(const Vec3& p, const Vec3& along, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, across = along.cross(ac);
  const double volume = ab.dot(across);
  if (!(std::abs(volume) > 1e-18)) return std::nullopt;
  const Vec3 from = p - a, side = from.cross(ab);
  const double u = from.dot(across) / volume, v = along.dot(side) / volume;
  if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0)) return std::nullopt;
  return ac.dot(side) / volume;
}

}  // namespace

Ground groundBelow(const std::vector<Vec3>& position, const std::vector<Index3>& triangle, const Vec3& p,
                   const Vec3& down, double above) {
  Ground ground;
  const auto vertices = static_cast<int>(position.size());
  for (const Index3& t : triangle) {
    if (std::min({t[0], t[1], t[2]}) < 0 || std::max({t[0], t[1], t[2]}) >= vertices) continue;
    const Vec3& a = position[static_cast<std::size_t>(t[0])];
    const Vec3& b = position[static_cast<std::size_t>(t[1])];
    const Vec3& c = position[static_cast<std::size_t>(t[2])];
    const auto below = meet(p, down, a, b, c);
    if (!below || *below < -above || *below >= ground.below) continue;
    const Vec3 normal = (b - a).cross(c - a).normalized();
    if (normal.dot(down) < 0.0) ground = {*below, normal};
  }
  return ground;
}

}  // namespace calot
