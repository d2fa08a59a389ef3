// SPDX-License-Identifier: GPL-3.0-or-later
// The search for nearest points of a deforming surface, and what can be told without one. Internal to this folder.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/surface_patches.h"
#include "sim/contact/surface_surface.h"
#include "sim/contact/triangle_lanes.h"
#include "sim/geometry/closest_point.h"
#include "sim/math/linear.h"

namespace calot {

/// Triangles of some patches in lanes, with their boxes.
class Candidates {
 public:
  /// Takes in what of the patches overlaps the box.
  void gather(const ContactSurface& surface, std::span<const Vec3> position, std::span<const std::uint32_t> patches,
              const Box& box);

  /// Calls f(triangle, squared distance) for every triangle no farther from p than `best` (m^2), which f may lower.
  /// @param first group to begin with: one that is near lowers `best` early
  /// @return the last group in which f lowered it, or `first`
  template <class F>
  std::size_t forEachNear(const Vec3& p, double& best, F&& f, std::size_t first = 0) const {
    std::size_t lowered = first;
    for (std::size_t k = 0; k < group_.size(); ++k) {
      const std::size_t g = k == 0 ? first : (k <= first ? k - 1 : k);
      if (boxDistance(whole_[g], p) > best) continue;
      const double before = best;
      LaneValues squared;
      boxDistances(bounds_[g], p, squared);
      if (!anyWithin(squared, best)) continue;
      pointTriangleDistances(group_[g], p, squared);
      const std::span<const std::uint32_t> lanes = lanesOf(g);
      for (std::size_t l = 0; l < lanes.size(); ++l) {
        if (squared[l] <= best) f(lanes[l], squared[l]);
      }
      if (best < before) lowered = g;
    }
    return lowered;
  }

 private:
  static void boundsOf(const TriangleLanes& group, BoundsLanes& bounds, Box& whole);
  static double boxDistance(const Box& box, const Vec3& p);
  static bool anyWithin(const LaneValues& squared, double best);

  [[nodiscard]] std::span<const std::uint32_t> lanesOf(std::size_t g) const {
    const std::size_t first = g * laneCount;
    return {triangle_.data() + first, std::min<std::size_t>(laneCount, triangle_.size() - first)};
  }

  std::vector<std::uint32_t> triangle_;
  std::vector<TriangleLanes> group_;
  std::vector<BoundsLanes> bounds_;
  std::vector<Box> whole_;  ///< of each group
};

/// The nearest point of a surface to a vertex, as far as one counts.
struct Near {
  bool found = false;
  std::size_t triangle = 0;
  PointTriangle point;
  Vec3 normal = Vec3::Zero();  ///< unit, towards the vertex or outward
  double distance = 0.0;       ///< signed (m)
};

Displacement displacementOf(std::span<const int> nodes, std::span<const Vec3> position, std::span<const Vec3> rest);

/// Bounds of the nodes that belong to a patch, grown by `margin`.
Box boundsOf(const ContactSurface& surface, std::span<const Vec3> position, std::uint32_t patch, double margin);

std::vector<std::uint32_t> allPatches(const ContactSurface& surface);

/// What a search writes to; kept, so that searching again allocates nothing.
struct SearchRoom {
  Candidates candidates;
  std::vector<std::uint32_t> near;         ///< patches of triangles near the patch of vertices at hand
  std::vector<std::uint32_t> kept;         ///< of those, the ones not settled by their displacement
  std::vector<std::size_t> open;           ///< vertices of the patch at hand that are not settled, by place in it
  std::vector<Displacement> displacement;  ///< per patch of triangles, made when first asked for
};

/// Nearest points of a surface to vertices of another surface or of itself.
class SurfaceSearch {
 public:
  SurfaceSearch(const SurfacePair& pair, const ContactSurface& a, std::span<const Vec3> positionA,
                const ContactSurface& b, std::span<const Vec3> positionB, SearchRoom& room);

  /// Takes one patch of vertices and the patches of triangles near it. @return false: none of it can be in contact
  bool take(std::uint32_t patch, std::span<const std::uint32_t> near, double reach);
  /// Makes nearest() ready for the patch taken.
  void gather();
  /// The same for rest: every triangle that reaches into the box.
  void gather(const Box& box);

  /// Can it be told from the displacements that a vertex of the patch taken is outside, farther than `reach`?
  [[nodiscard]] bool surelyFar(std::size_t vertex, double reach) const;

  /// How far a vertex is searched from (m).
  [[nodiscard]] double limitOf(std::size_t vertex, double reach) const;

  /// The least distance, ties to the lower triangle: in which order groups are looked at changes nothing, but the one
  /// where the last vertex, most often a neighbour, found its own makes the others short.
  [[nodiscard]] Near nearest(int vertex, const Vec3& p, double limit);

  /// One triangle that is not excluded, where nearest() is worked out from elsewhere: takes it if it is no farther than
  /// `best` (m^2), which it lowers, and counts.
  void offer(const Vec3& p, std::size_t triangle, Near& near, double& best) const;
  /// Side, distance and normal of what was found.
  void measure(const Vec3& p, Near& near) const;

  [[nodiscard]] const SurfacePair& pair() const { return pair_; }
  [[nodiscard]] const ContactSurface& a() const { return a_; }
  [[nodiscard]] const ContactSurface& b() const { return b_; }
  [[nodiscard]] std::span<const Vec3> positionA() const { return positionA_; }
  [[nodiscard]] std::span<const Vec3> positionB() const { return positionB_; }
  [[nodiscard]] SearchRoom& room() const { return room_; }

 private:
  [[nodiscard]] const Vec3& at(int node) const { return positionB_[static_cast<std::size_t>(node)]; }

  const SurfacePair& pair_;
  const ContactSurface& a_;
  std::span<const Vec3> positionA_;
  const ContactSurface& b_;
  std::span<const Vec3> positionB_;
  SearchRoom& room_;
  std::size_t last_ = 0;                 ///< group of the candidates in which the last nearest point was found
  std::span<const std::uint32_t> near_;  ///< of the patch taken, kept or not
  std::uint32_t patch_ = 0;              ///< taken
  double limit_ = 0.0;                   ///< of the patch taken (m)
};

}  // namespace calot
