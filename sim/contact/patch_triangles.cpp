// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/patch_triangles.h"

#include <algorithm>
#include <numeric>

namespace calot {

void PatchTriangles::begin(const ContactSurface& surface, std::span<const Vec3> position) {
  surface_ = &surface;
  position_ = position;
  patch_.resize(surface.patches().size());
  for (Patch& patch : patch_) patch.made = false;
}

void PatchTriangles::make(std::uint32_t patch) {
  Patch& own = patch_[patch];
  own.made = true;
  own.first = surface_->patches()[patch].first;
  const std::size_t last = surface_->patches()[patch].last;
  own.count = laneGroups(last - own.first);
  for (std::size_t g = 0; g < own.count; ++g) {
    Group& group = own.group[g];
    std::array<std::uint32_t, laneCount> triangle{};
    const std::size_t from = own.first + g * laneCount;
    std::iota(triangle.begin(), triangle.end(), static_cast<std::uint32_t>(from));
    gatherTriangles(*surface_, position_, {triangle.data(), std::min<std::size_t>(laneCount, last - from)},
                    group.triangles);
    boxesOf(group.triangles, group.box);
    group.slivers = 0;
    for (std::size_t l = 0; l < laneCount; ++l) group.slivers |= (isSliver(group.triangles, l) ? 1U : 0U) << l;
    for (std::size_t a = 0; a < 3; ++a) {
      own.whole.lower[a][g] = *std::min_element(group.box.lower[a], group.box.lower[a] + laneCount);
      own.whole.upper[a][g] = *std::max_element(group.box.upper[a], group.box.upper[a] + laneCount);
    }
  }
}

}  // namespace calot
