// SPDX-License-Identifier: GPL-3.0-or-later
// Narrow phase: vertices of one deforming surface against the triangles of another, or of the same surface.
//
// Each vertex is tested against its nearest point on the other surface. The pseudonormal of the nearest feature gives
// the side (a face's normal; the sum of both for an edge; the angle-weighted sum for a vertex: Baerentzen and Aanaes
// 2005), which is exact for a closed surface. A vertex above a thin part is thus never classified as inside its far
// side, and overlaps are detected down to `maxOverlap`. Edge-edge contact is left to the vertices of the finer surface.
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/broad_phase.h"
#include "sim/contact/surface_patches.h"
#include "sim/contact/triangle_lanes.h"
#include "sim/geometry/closest_point.h"
#include "sim/math/linear.h"

namespace calot {

/// Greatest overlap that is detected, beyond the rest offset (m).
inline constexpr double maxOverlap = 0.005;

/// One vertex near the other surface.
struct VertexContact {
  int vertex = 0;              ///< of the first surface
  std::array<int, 3> node{};   ///< corners of the triangle, of the second surface
  Vec3 weight = Vec3::Zero();  ///< barycentric coordinates of the nearest point
  Vec3 normal = Vec3::Zero();  ///< unit, from the triangle's surface towards the vertex's (outward when inside)
  double gap = 0.0;            ///< signed distance less the rest offset, negative: deeper inside than at rest (m)
  std::uint64_t key = 0;       ///< patches of vertex and triangle (bits 20 to 39 and 0 to 19): unique within one result
};

class NearTriangles;
struct SurfaceDisplacement;
struct TriangleLanes;

/// Reference data for the vertices of one surface and the triangles of another or of the same; part of Model.
class SurfacePair {
 public:
  /// Two closed surfaces. Vertices that are inside at rest get a rest offset of any depth, from
  /// which gaps are measured.
  SurfacePair(const ContactSurface& vertices, std::span<const Vec3> vertexRest, const ContactSurface& triangles,
              std::span<const Vec3> triangleRest);

  /// A closed surface with itself. Contacts are local minima of the distance from a vertex. A vertex
  /// is never tested against
  /// - a triangle nearer at rest than selfMultiple times the vertex's mean edge length (a table);
  /// - a triangle that it lies straight behind at rest, within `maxPartThickness`: opposite sides of a part
  ///   that may be squeezed.
  SurfacePair(const ContactSurface& surface, std::span<const Vec3> rest);

  static constexpr double selfMultiple = 4.0;
  static constexpr double maxPartThickness = 0.03;  ///< m
  static constexpr double known = 0.015;            ///< distances at rest are known up to this (m)

  [[nodiscard]] bool self() const { return self_; }
  [[nodiscard]] std::span<const Vec3> vertexRest() const { return restA_; }
  [[nodiscard]] std::span<const Vec3> triangleRest() const { return restB_; }
  /// min(0, signed distance at rest) of each vertex (m).
  [[nodiscard]] std::span<const double> restOffset() const { return offset_; }
  /// Margin by which the box of a patch of vertices must be grown for the broad phase (m).
  [[nodiscard]] double search(std::uint32_t patch, double reach) const { return std::max(reach, depth_[patch]); }
  /// True if this triangle is never tested against this vertex. Always false between two surfaces.
  [[nodiscard]] bool excluded(int vertex, std::size_t triangle) const;
  /// The same for up to eight consecutive triangles. @param rest their reference positions
  /// @return a bit for each triangle that is not excluded
  [[nodiscard]] std::uint32_t notExcluded(int vertex, std::size_t first, std::size_t count,
                                          const TriangleLanes& rest) const;

 private:
  friend class SurfaceSearch;
  friend void patchesInPlay(const SurfacePair& pair, const SurfaceDisplacement& a, const SurfaceDisplacement& b,
                            double reach, std::vector<std::uint32_t>& out);
  void measureRest(const ContactSurface& a, const ContactSurface& b);
  [[nodiscard]] bool liesBehind(std::size_t vertex, std::size_t triangle, double squared) const;
  [[nodiscard]] std::span<const std::uint32_t> listed(std::size_t vertex) const {
    return {excluded_.data() + excludedStart_[vertex], excludedStart_[vertex + 1] - excludedStart_[vertex]};
  }

  bool self_ = false;
  std::vector<Vec3> restA_;
  std::vector<Vec3> restB_;
  std::vector<Index3> triangle_;  ///< of b
  std::vector<Vec3> normal_;      ///< rest normals of twice the area, for a surface with itself (m^2)
  std::vector<double> offset_;
  std::vector<double> depth_;  ///< per patch: maxOverlap less the least offset of its vertices
  std::vector<std::size_t> excludedStart_;
  std::vector<std::uint32_t> excluded_;
  // Unsigned distances at rest to triangles that are not excluded, capped at `known` (m): per vertex, and
  // per pair of patches.
  std::vector<double> vertexDistance_;
  std::vector<double> patchDistance_;
  std::vector<double> minDistance_;  ///< of each patch of vertices to all patches of triangles
  std::size_t patchesB_ = 0;
};

/// Displacement of nodes from the reference configuration: mean and greatest deviation from it (m).
struct Displacement {
  Vec3 mean = Vec3::Zero();
  double spread = -1.0;  ///< negative: not computed yet
};

/// Displacement of a surface, computed once for all its pairs.
struct SurfaceDisplacement {
  std::vector<Displacement> patch;  ///< of each patch's nodes
  Displacement whole;
};
void measureDisplacement(const ContactSurface& surface, std::span<const Vec3> position, std::span<const Vec3> rest,
                         SurfaceDisplacement& out);

/// Patches of `a` that can be in contact at all, ascending. Only these need a broad-phase query (and query indices
/// refer to them); the others have not moved enough relative to the whole of `b`.
/// @pre displacements are from the pair's rest
void patchesInPlay(const SurfacePair& pair, const SurfaceDisplacement& a, const SurfaceDisplacement& b, double reach,
                   std::vector<std::uint32_t>& out);

/// Finds the contacts of `a`'s vertices with `b`'s triangles (for a surface with itself, both are the same).
///
/// Per pair (patch of vertices, patch of triangles) only the vertex with the smallest gap is reported, ties to the
/// lower index: this bounds the number of rows and still gives every touching region one. Most pairs are excluded
/// without testing triangles: two patches that were d apart at rest and have moved by at most m relative to each other
/// are at least d - m apart, on the same side. This does not change the result.
/// @param pairs query: patch of a, leaf: patch of b, sorted by query: from a broad phase over b's patches, queried with
/// a's patch boxes grown by pair.search()
/// @param reach contacts with a gap of this or more are omitted (m)
/// @param memory lists of this pair, reused from step to step: they speed up searches far from rest and never change
/// the result; may be null Results are appended in order of their keys.
void surfaceContacts(const SurfacePair& pair, const ContactSurface& a, std::span<const Vec3> positionA,
                     const ContactSurface& b, std::span<const Vec3> positionB, std::span<const BroadPhase::Pair> pairs,
                     double reach, std::vector<VertexContact>& out, NearTriangles* memory = nullptr);

// Nearest points of a deforming surface, and the tests that make a search unnecessary. Internal to this folder.

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

// Neighbour lists (Verlet 1967): triangles of a surface that were recently near the vertices of another or
// of the same one.
//
// Far from the reference configuration, displacements since rest exclude few pairs. A search for a patch of vertices
// therefore extends `margin` beyond the distance that matters and stores the triangles found, their distances and all
// positions. As long as a vertex and the nearby triangles have moved relative to each other by less than the margin, no
// other triangle can have come within that distance, and only listed triangles that were within that distance plus the
// relative displacement need a test. A rigid motion that all of them share does not count as relative displacement. In
// fast motion, where lists would expire too soon to pay off, the margin is zero. Per step, only a third of the patches
// may build a list with a margin, which spreads the cost.
//
// Lists only exclude triangles; the side of a vertex follows from current positions alone. Results are therefore
// identical with lists of any age and without lists, and none of this is part of State.

/// Lists for the vertices of one SurfacePair. Memory is reused from step to step.
class NearTriangles {
 public:
  static constexpr double margin = 0.003;  ///< search distance beyond the one that matters (m)

  /// Work counters since reset().
  struct Counts {
    std::size_t rebuilt = 0;   ///< patches of vertices whose lists were rebuilt
    std::size_t searched = 0;  ///< vertices with at least one triangle to test
    std::size_t tested = 0;    ///< triangles tested
  };

  /// Drops all lists; keeps their memory.
  void reset();
  [[nodiscard]] const Counts& counts() const { return counts_; }

  /// Precomputes the exclusion masks that lists of a surface with itself need. @param surface at rest
  void precompute(const SurfacePair& pair, const ContactSurface& surface);

  /// Call once per search, after the surfaces have moved and before the first patch.
  void begin(const SurfaceSearch& search);
  /// Prepares nearest() for the open vertices of a patch (SearchScratch::open): reuses the lists if they are valid for
  /// all of them, else rebuilds them.
  /// @param near patches whose bounds overlap those of the patch grown by search(), or more
  void updateLists(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near, double reach);
  /// Same result as SurfaceSearch::nearest() with limitOf(). @param index of the vertex in its patch
  [[nodiscard]] Near nearest(const SurfaceSearch& search, std::size_t index, double reach);

  SearchScratch& scratch() { return scratch_; }

 private:
  static constexpr std::size_t unknown = ~std::size_t{0};
  struct Entry {
    float distance = 0.0F;  ///< lower bound when the list was built (m)
    std::uint32_t triangle = 0;
    auto operator<=>(const Entry&) const = default;  // NOLINT(modernize-use-nullptr): the check's own fault
  };
  using Padded = std::array<double, 4>;  ///< a position (m), padded to four numbers

  /// List of one patch of vertices.
  struct List {
    bool made = false;
    double reach = 0.0;                 ///< when the list was built (m)
    double margin = 0.0;                ///< NearTriangles::margin, or 0 in fast motion
    double speed = 0.0;                 ///< mean relative displacement since the list was built (m per step)
    std::uint64_t age = 0;              ///< step in which the list was built
    bool rotating = false;              ///< moved so far that a common rotation is removed
    std::vector<std::uint32_t> patch;   ///< patches of triangles whose corners are stored; ascending
    std::vector<std::size_t> start;     ///< per such patch: its start in `corner`; then the end
    std::vector<Padded> corner;         ///< corner positions (m)
    std::vector<Vec3> vertex;           ///< positions of the patch's own vertices (m)
    std::vector<std::size_t> entryEnd;  ///< per vertex
    std::vector<Entry> entry;           ///< nearest first
  };

  double measure(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near,
                 const std::array<Padded, 4>* rigid);
  double measureRotated(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near);
  bool isValid(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near, double reach);
  void rebuild(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near, double reach);
  void readBounds(const SurfaceSearch& search);
  void count(const SurfacePair& pair, const ContactSurface& surface, std::uint32_t vertices, std::uint32_t triangles);

  SearchScratch scratch_;
  std::vector<List> list_;  ///< per patch of vertices
  PatchTriangles triangles_;
  /// For a surface with itself: per patch of vertices and patch of triangles, its start in `included_`.
  std::vector<std::size_t> includedStart_;
  /// Per vertex and group of eight triangles: a bit for each triangle that SurfacePair does not exclude.
  std::vector<std::uint8_t> included_;
  std::vector<Padded> now_;                  ///< current node positions of the triangles' surface (m)
  std::vector<Box> bounds_;                  ///< current bounds of the patches of triangles; empty until needed
  std::vector<const Padded*> was_;           ///< per near patch: its stored corner positions
  std::vector<Vec3> sampleWas_, sampleNow_;  ///< of measureRotated()
  std::vector<double> displaced_;  ///< per vertex of the current patch: upper bound of its displacement relative to
                                   ///< nearby triangles (m)
  std::uint32_t patch_ = 0;        ///< current patch
  std::uint64_t age_ = 0;          ///< steps
  Counts counts_;
};

// Rigid motion fitted to some points. Internal to this folder.

/// Least-squares rigid motion x -> rotation x + shift from `was` to `now`, by two Gauss-Newton steps: enough for a
/// tenth of a revolution. The result is rigid for any input. @pre was.size() == now.size() > 0
struct RigidMotion {
  Mat3 rotation = Mat3::Identity();
  Vec3 shift = Vec3::Zero();

  RigidMotion(std::span<const Vec3> was, std::span<const Vec3> now) {
    Vec3 from = Vec3::Zero();
    Vec3 to = Vec3::Zero();
    for (std::size_t i = 0; i < was.size(); ++i) {
      from += was[i] / static_cast<double>(was.size());
      to += now[i] / static_cast<double>(was.size());
    }
    for (int step = 0; step < 2; ++step) {
      Mat3 inertia = Mat3::Zero();
      Vec3 moment = Vec3::Zero();
      for (std::size_t i = 0; i < was.size(); ++i) {
        const Vec3 arm = rotation * (was[i] - from);
        inertia += arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose();
        moment += arm.cross(now[i] - to);
      }
      const Vec3 half = 0.5 * (inertia.inverse() * moment);
      if (!(half.squaredNorm() < 1.0)) break;  // collinear points or too large a rotation: stop here
      rotation = Quat(1.0, half[0], half[1], half[2]).normalized().toRotationMatrix() * rotation;
    }
    shift = to - rotation * from;
  }
};

}  // namespace calot
