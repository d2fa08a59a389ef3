// SPDX-License-Identifier: GPL-3.0-or-later
// Squared distances of eight triangles at once. The bits are those of the scalar functions of
// sim/geometry/closest_point.h (tests/sim/contact/triangle_lanes_test.cpp): lanes select the relevant triangles, and
// scalar code then evaluates foot points and features of those few.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/broad_phase.h"
#include "sim/contact/surface_patches.h"
#include "sim/math/linear.h"
#include "sim/math/vectors.h"

namespace calot {

using LaneValues = std::array<double, laneCount>;

/// Eight triangles: corner, coordinate, lane (m).
struct TriangleLanes {
  alignas(64) double corner[3][3][laneCount];
};

/// Eight boxes: coordinate, lane (m).
struct BoundsLanes {
  alignas(64) double lower[3][laneCount];
  alignas(64) double upper[3][laneCount];
};

/// Triangles of a patch whose boxes overlap `box`, ascending, written to `near`. @return how many
std::size_t trianglesInBox(const ContactSurface& surface, std::span<const Vec3> position, std::uint32_t patch,
                           const Box& box, std::array<std::uint32_t, ContactSurface::maxPatchTriangles>& near);

/// Takes in up to eight triangles; lanes that are left over repeat the last. @pre triangles is not empty
void gatherTriangles(const ContactSurface& surface, std::span<const Vec3> position,
                     std::span<const std::uint32_t> triangles, TriangleLanes& out);

/// The box of each triangle.
void boxesOf(const TriangleLanes& triangles, BoundsLanes& out);

/// True if the triangle of a lane is so flat (sine of its angle below 1e-3) that rounding moves the foot of
/// a perpendicular on it?
bool isSliver(const TriangleLanes& triangles, std::size_t lane);

/// A little less than the squared distance of p from each box, so that rounding loses no triangle (m^2).
void boxDistances(const BoundsLanes& boxes, const Vec3& p, LaneValues& squared);

/// closestSegmentTriangle(p0, p1, triangle).squaredDistance of each lane (m^2).
void segmentTriangleDistances(const TriangleLanes& triangles, const Vec3& p0, const Vec3& p1, LaneValues& squared);

/// closestOnTriangle(p, triangle).squaredDistance of each lane (m^2).
void pointTriangleDistances(const TriangleLanes& triangles, const Vec3& p, LaneValues& squared);

/// Triangles of a surface's patches and their boxes in lanes, eight at a time in index order. Built when a patch is
/// first needed and shared by all vertices near it.
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
