// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/sight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace calot::gui {
namespace {

constexpr double litOverSeen = 1.25;  // width of the light's field over the picture's
/// A shadow falls aside by less than the light is beside the lens (m).
constexpr double shadowReach = 0.006;
constexpr double nearest = 0.004;  // m: nearer than that may be cut by the near plane

}  // namespace

double Sight::lit() const { return litOverSeen * std::max(aside, up); }

Sight sightOf(int width, int height, double verticalFieldOfView, bool field) {
  const double w = width, h = height;
  Sight sight;
  sight.up = std::tan(0.5 * verticalFieldOfView);
  sight.aside = sight.up * w / h;
  if (!field) return sight;
  // What lies around the field is black, and costs nothing. Wide pictures cut it above and below.
  const double rim = 0.5 * std::min(w, h) * (width == height ? 0.985 : 1.12);
  constexpr double feather = 1.5;
  constexpr double beyond = 8.0;  // pixels, so that passes of half the size have neighbours at the rim
  const double half = (rim + feather + beyond) / std::cos(std::numbers::pi / fieldSides);
  sight.rim = static_cast<float>(rim);
  sight.feather = static_cast<float>(feather);
  sight.halfX = static_cast<float>(2.0 * half / w);
  sight.halfY = static_cast<float>(2.0 * half / h);
  sight.aside *= std::min(1.0, 2.0 * half / w);
  sight.up *= std::min(1.0, 2.0 * half / h);
  return sight;
}

std::uint8_t placeIn(const Sight& sight, const Vec3& p_C) {
  const double x = sight.aside * p_C.z(), y = sight.up * p_C.z();
  const bool within = p_C.z() > nearest && std::abs(p_C.x()) < x && std::abs(p_C.y()) < y;
  const unsigned sides = (p_C.z() <= 0.0 ? 1U : 0U) | (p_C.x() > x + shadowReach ? 2U : 0U) |
                         (-p_C.x() > x + shadowReach ? 4U : 0U) | (p_C.y() > y + shadowReach ? 8U : 0U) |
                         (-p_C.y() > y + shadowReach ? 16U : 0U);
  return static_cast<std::uint8_t>(within ? 0U : sides | Place::edge);
}

bool turnedAway(const Vec3& a, const Vec3& b, const Vec3& c) {
  static const Vec3 light(static_cast<double>(lightX), static_cast<double>(lightY), 0.0);
  const Vec3 normal = (b - a).cross(c - a);
  return normal.dot(a) > 0.0 && normal.dot(a - light) > 0.0;
}

}  // namespace calot::gui
