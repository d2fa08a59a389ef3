// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles of a surface's patches and their boxes in lanes, eight at a time in index order. Built when a patch is
// first needed and shared by all vertices near it. Internal to this folder.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/broad_phase.h"
#include "sim/contact/surface_patches.h"
#include "sim/contact/triangle_lanes.h"
#include "sim/math/linear.h"

namespace calot {

class PatchTriangles {
 public:
  static constexpr std::size_t groups = laneGroups(ContactSurface::maxPatchTriangles);  ///< in a patch, at most

  /// Invalidates everything: the surface has moved. @param surface, position outlive the calls that follow
  void begin(const ContactSurface& surface, std::span<const Vec3> position);

  /// Selects the triangles of some patches that overlap a box, for forEachWithin().
  void choose(std::span<const std::uint32_t> patches, const Box& box);

  /// Calls f(triangle, squared) for the selected triangles that may be within the distance. `squared` is a lower bound
  /// of the squared distance (m^2), good to 1e-9 m; it is 0 for a sliver, whose computed foot point is unreliable.
  /// @param counting counting(patch, group) returns a bit for each lane to consider: triangle 8 group +
  /// lane of the patch
  /// @pre p lies in the box of choose(), at least `distance` from its sides
  template <class C, class F>
  void forEachWithin(const Vec3& p, double distance, C&& counting, F&& f) {
    const Ball ball(p, distance);
    within(whole_, ball, hit_);
    near_.clear();
    nearBoxes_.clear();
    for (std::size_t w = 0; w < whole_.size(); ++w) {
      for (std::uint32_t lanes = hit_[w]; lanes != 0; lanes &= lanes - 1) {
        const Chosen& chosen = chosen_[w * laneCount + static_cast<std::size_t>(std::countr_zero(lanes))];
        const std::uint32_t counts = counting(chosen.patch, chosen.group);
        if (counts == 0) continue;
        near_.push_back({&chosen, counts});
        nearBoxes_.push_back(&chosen.of->box);
      }
    }
    within(nearBoxes_, ball, hit_);
    const double maximum = distance * distance;
    for (std::size_t n = 0; n < near_.size(); ++n) {
      std::uint32_t lanes = near_[n].counts & hit_[n];
      if (lanes == 0) continue;
      const Group& group = *near_[n].chosen->of;
      LaneValues squared;
      pointTriangleDistances(group.triangles, p, squared);
      for (; lanes != 0; lanes &= lanes - 1) {
        const auto l = static_cast<std::size_t>(std::countr_zero(lanes));
        const double minimum = (group.slivers >> l & 1U) != 0 ? 0.0 : squared[l];
        if (!(minimum > maximum)) f(group.first + l, minimum);
      }
    }
  }

 private:
  struct Group {
    TriangleLanes triangles;
    BoxLanes box;               ///< of each triangle
    std::size_t first = 0;      ///< triangle
    std::uint32_t slivers = 0;  ///< a bit for each lane
  };
  struct Patch {
    bool made = false;
    std::size_t count = 0;  ///< of groups
    BoxLanes whole;         ///< of each group
    std::array<Group, groups> group;
  };
  struct Chosen {
    std::uint32_t patch = 0;
    std::uint32_t group = 0;
    const Group* of = nullptr;
  };
  struct Near {
    const Chosen* chosen;
    std::uint32_t counts;  ///< a bit for each lane
  };
  /// A ball, rounded outward to float.
  struct Ball {
    Ball(const Vec3& p, double distance);
    std::array<float, 3> lower{}, upper{};
    float squared;
  };

  const Patch& of(std::uint32_t patch) {
    if (!patch_[patch].made) make(patch);
    return patch_[patch];
  }
  void make(std::uint32_t patch);
  /// A bit for each lane whose box may overlap the ball.
  static void within(std::span<const BoxLanes* const> boxes, const Ball& ball, std::vector<std::uint8_t>& hit);

  const ContactSurface* surface_ = nullptr;
  std::span<const Vec3> position_;
  std::vector<Patch> patch_;
  std::vector<Chosen> chosen_;
  std::vector<BoxLanes> chosenBoxes_;  ///< of groups
  std::vector<const BoxLanes*> whole_, nearBoxes_;
  std::vector<Near> near_;
  std::vector<std::uint8_t> hit_;
};

}  // namespace calot
