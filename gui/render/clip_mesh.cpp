// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/clip_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "gui/render/loft.h"

namespace calot::gui {

Mesh makeClip(const ClipView& clip) {
  constexpr int around = 12, bend = 10, straight = 5;
  const double thickness = 0.5 * clip.width;
  // Distance of a leg's centre line from the vessel's. Legs slightly penetrate the wall, so that no surfaces coincide.
  const double offset = 0.75 * clip.halfGap + 0.5 * thickness;
  const double loop = std::max(1.25 * offset, thickness);  // radius of the crotch
  const double tip = 0.5 * clip.legs, crotch = -0.5 * clip.legs + loop;

  std::vector<Vec3> path;
  path.reserve(2 * straight + bend + 1);             // from one leg's tip around the crotch to the other's
  const auto leg = [&](double side, double share) {  // share 0 at the tip, 1 where the crotch begins
    const double open = share * share * (3.0 - 2.0 * share);
    return Vec3(side * (offset + (loop - offset) * open * open), tip + share * (crotch - tip), 0.0);
  };
  for (int i = 0; i < straight; ++i) path.push_back(leg(1.0, static_cast<double>(i) / straight));
  for (int i = 0; i <= bend; ++i) {
    const double angle = std::numbers::pi * i / bend;
    path.emplace_back(loop * std::cos(angle), crotch - loop * std::sin(angle), 0.0);
  }
  for (int i = straight - 1; i >= 0; --i) path.push_back(leg(-1.0, static_cast<double>(i) / straight));

  std::vector<Ring> rings;
  const Ring section = superellipse(Vec3::Zero(), 0.5 * thickness, 0.5 * clip.width, 3.0, around);
  const std::size_t last = path.size() - 1;
  const auto ringAt = [&](const Vec3& centre, const Vec3& along, double size) {
    const Vec3 side = Vec3::UnitZ().cross(along);
    Ring ring;
    for (const Vec3& p : section) ring.push_back(centre + size * (p.x() * side + p.y() * Vec3::UnitZ()));
    rings.push_back(ring);
  };
  for (std::size_t i = 0; i <= last; ++i) {
    const Vec3 along = (path[std::min(i + 1, last)] - path[i > 0 ? i - 1 : 0]).normalized();
    const double round = 0.3 * thickness;  // of the tips' edges
    if (i == 0) ringAt(path[i] - round * along, along, 0.75);
    ringAt(path[i], along, 1.0);
    if (i == last) ringAt(path[i] + round * along, along, 0.75);
  }
  return loft(rings);
}

}  // namespace calot::gui
