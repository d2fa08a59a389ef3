// SPDX-License-Identifier: GPL-3.0-or-later
// The triangles of a surface's patches in lanes, eight at a time in the order of their numbers, with their boxes: made
// for a patch when it is first asked for, and shared by all vertices that come near it. Internal to this folder.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/surface_patches.h"
#include "sim/contact/triangle_lanes.h"
#include "sim/math/linear.h"

namespace calot {

class PatchTriangles {
 public:
  static constexpr std::size_t groups = laneGroups(ContactSurface::largestPatch);  ///< in a patch, at most
  static_assert(groups == laneCount && laneCount == 8);

  /// The surface has moved: what was made is no longer true. @param surface, position outlive the calls that follow
  void begin(const ContactSurface& surface, std::span<const Vec3> position);

  /// Calls f(triangle, squared) for the triangles of a patch that may be within the distance, with a lower bound of
  /// their squared distance (m^2), good to 1e-9 m: that of the box for a sliver, whose computed foot may be off.
  /// @param counting counting(group) tells which lanes matter, a bit for each: triangles 8 group + lane of the patch
  template <class C, class F>
  void forEachWithin(std::uint32_t patch, const Vec3& p, double distance, C&& counting, F&& f) {
    const Patch& own = of(patch);
    const double most = distance * distance;
    LaneValues whole;
    boxDistances(own.whole, p, whole);
    for (std::size_t g = 0; g < own.count; ++g) {
      if (whole[g] > most) continue;
      std::uint32_t lanes = counting(g);
      if (lanes == 0) continue;
      const Group& group = own.group[g];
      LaneValues box;
      boxDistances(group.box, p, box);
      std::uint32_t within = 0;
      for (std::size_t l = 0; l < laneCount; ++l) within |= (box[l] > most ? 0U : 1U) << l;
      lanes &= within;
      if (lanes == 0) continue;
      LaneValues squared;
      pointTriangleDistances(group.triangles, p, squared);
      for (; lanes != 0; lanes &= lanes - 1) {
        const auto l = static_cast<std::size_t>(std::countr_zero(lanes));
        const double least = (group.slivers >> l & 1U) != 0 ? box[l] : squared[l];
        if (!(least > most)) f(own.first + g * laneCount + l, least);
      }
    }
  }

 private:
  struct Group {
    TriangleLanes triangles;
    BoundsLanes box;
    std::uint32_t slivers = 0;  ///< a bit for each lane
  };
  struct Patch {
    bool made = false;
    std::size_t first = 0;  ///< triangle
    std::size_t count = 0;  ///< of groups
    BoundsLanes whole;      ///< of each group
    std::array<Group, groups> group;
  };

  const Patch& of(std::uint32_t patch) {
    if (!patch_[patch].made) make(patch);
    return patch_[patch];
  }
  void make(std::uint32_t patch);

  const ContactSurface* surface_ = nullptr;
  std::span<const Vec3> position_;
  std::vector<Patch> patch_;
};

}  // namespace calot
