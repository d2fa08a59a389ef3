// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest points of a deforming surface, and the tests that make a search unnecessary. Internal to this folder.
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
  /// Gathers the triangles of the patches that overlap the box.
  void gather(const ContactSurface& surface, std::span<const Vec3> position, std::span<const std::uint32_t> patches,
              const Box& box);

  /// Calls f(triangle, squared distance) for every triangle within squared distance `best` of p (m^2);
  /// f may lower `best`.
  /// @param first group to start with: a near one lowers `best` early
  /// @return the last group in which f lowered `best`, or `first`
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

/// Nearest point of a surface to a vertex, within the search distance.
struct Near {
  bool found = false;
  std::size_t triangle = 0;
  PointTriangle point;
  Vec3 normal = Vec3::Zero();  ///< unit, towards the vertex or outward
  double distance = 0.0;       ///< signed (m)
};

Displacement displacementOf(std::span<const int> nodes, std::span<const Vec3> position, std::span<const Vec3> rest);

/// Bounds of a patch's nodes, grown by `margin`.
Box boundsOf(const ContactSurface& surface, std::span<const Vec3> position, std::uint32_t patch, double margin);

std::vector<std::uint32_t> allPatches(const ContactSurface& surface);

/// Scratch memory of a search, reused so that later searches allocate nothing.
struct SearchScratch {
  Candidates candidates;
  std::vector<std::uint32_t> near;         ///< patches of triangles near the current patch of vertices
  std::vector<std::uint32_t> kept;         ///< those of `near` that displacement does not exclude
  std::vector<std::size_t> open;           ///< vertices of the current patch that need a search, by index in it
  std::vector<Displacement> displacement;  ///< per patch of triangles, computed on demand
};

/// Nearest points of a surface to vertices of another surface or of itself.
class SurfaceSearch {
 public:
  SurfaceSearch(const SurfacePair& pair, const ContactSurface& a, std::span<const Vec3> positionA,
                const ContactSurface& b, std::span<const Vec3> positionB, SearchScratch& scratch);

  /// Selects a patch of vertices and the patches of triangles near it. @return false if none of it can be in contact
  bool selectPatch(std::uint32_t patch, std::span<const std::uint32_t> near, double reach);
  /// Prepares nearest() for the selected patch.
  void gather();
  /// For the reference configuration: gathers every triangle that overlaps the box.
  void gather(const Box& box);

  /// Do displacements alone prove that a vertex of the selected patch is outside and farther than `reach`?
  [[nodiscard]] bool surelyFar(std::size_t vertex, double reach) const;

  /// Search distance of a vertex (m).
  [[nodiscard]] double limitOf(std::size_t vertex, double reach) const;

  /// Nearest point; ties go to the triangle with the lower index, so the result does not depend on the order of groups.
  /// Starting with the group of the previous vertex's result, usually a neighbour's, shortens the search.
  [[nodiscard]] Near nearest(int vertex, const Vec3& p, double limit);

  /// Tests one triangle that is not excluded, for callers that enumerate triangles themselves: accepts it if its
  /// squared distance is at most `best` (m^2) and it is a valid contact, and lowers `best`.
  void offer(const Vec3& p, std::size_t triangle, Near& near, double& best) const;
  /// Computes side, distance and normal of the point found.
  void measure(const Vec3& p, Near& near) const;

  [[nodiscard]] const SurfacePair& pair() const { return pair_; }
  [[nodiscard]] const ContactSurface& a() const { return a_; }
  [[nodiscard]] const ContactSurface& b() const { return b_; }
  [[nodiscard]] std::span<const Vec3> positionA() const { return positionA_; }
  [[nodiscard]] std::span<const Vec3> positionB() const { return positionB_; }
  [[nodiscard]] SearchScratch& scratch() const { return scratch_; }

 private:
  [[nodiscard]] const Vec3& at(int node) const { return positionB_[static_cast<std::size_t>(node)]; }

  const SurfacePair& pair_;
  const ContactSurface& a_;
  std::span<const Vec3> positionA_;
  const ContactSurface& b_;
  std::span<const Vec3> positionB_;
  SearchScratch& scratch_;
  std::size_t last_ = 0;                 ///< group of the previous nearest point
  std::span<const std::uint32_t> near_;  ///< patches near the selected patch
  std::uint32_t patch_ = 0;              ///< selected
  double limit_ = 0.0;                   ///< of the selected patch (m)
};

}  // namespace calot
