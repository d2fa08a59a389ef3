// SPDX-License-Identifier: GPL-3.0-or-later
// Narrow phase: vertices of one deforming surface against the triangles of another, or of the same surface.
//
// A vertex is held against its nearest point of the other surface. The side is the sign of the pseudonormal of the
// nearest feature (a face's normal; the sum of both for an edge; the angle-weighted sum for a vertex: Baerentzen and
// Aanaes 2005), which is exact for a closed surface. So a vertex above a thin part is never taken to be inside its far
// side, and inside is recognised down to `deepestOverlap`. Edge against edge is left to the finer of the two surfaces'
// vertices.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/broad_phase.h"
#include "sim/contact/surface_patches.h"
#include "sim/math/linear.h"

namespace calot {

/// A vertex deeper inside than this (beyond its rest offset) is not seen (m).
inline constexpr double deepestOverlap = 0.005;

/// One vertex near the other surface.
struct VertexContact {
  int vertex = 0;              ///< of the first surface
  std::array<int, 3> node{};   ///< corners of the triangle, of the second surface
  Vec3 weight = Vec3::Zero();  ///< barycentric coordinates of the nearest point
  Vec3 normal = Vec3::Zero();  ///< unit, from the triangle's surface towards the vertex's (outward when inside)
  double gap = 0.0;            ///< signed distance less the rest offset, negative: deeper inside than at rest (m)
  std::uint64_t key = 0;       ///< patches of vertex and triangle (bits 20 to 39 and 0 to 19): unique in one answer
};

class NearTriangles;
struct SurfaceDisplacement;
struct TriangleLanes;

/// What is known at rest of the vertices of one surface and the triangles of another or of the same; part of Model.
class SurfacePair {
 public:
  /// Two closed surfaces. Vertices that are inside at rest, however deep, get a rest offset: surfaces that overlap or
  /// touch at rest are counted from there.
  SurfacePair(const ContactSurface& vertices, std::span<const Vec3> vertexRest, const ContactSurface& triangles,
              std::span<const Vec3> triangleRest);

  /// A closed surface with itself. Contacts are places where its distance from a vertex is a local minimum. Never held
  /// against one another are a vertex and
  /// - a triangle that at rest is nearer than selfMultiple times the vertex's mean edge length (a table);
  /// - a triangle that at rest the vertex lies straight behind, across at most `thickest`: the two sides of a part,
  /// which
  ///   may be squeezed.
  SurfacePair(const ContactSurface& surface, std::span<const Vec3> rest);

  static constexpr double selfMultiple = 4.0;
  static constexpr double thickest = 0.03;  ///< m
  static constexpr double known = 0.015;    ///< distances at rest are known up to this (m)

  [[nodiscard]] bool self() const { return self_; }
  [[nodiscard]] std::span<const Vec3> vertexRest() const { return restA_; }
  [[nodiscard]] std::span<const Vec3> triangleRest() const { return restB_; }
  /// min(0, signed distance at rest) of each vertex (m).
  [[nodiscard]] std::span<const double> restOffset() const { return offset_; }
  /// How far the box of a patch of vertices must be grown for the broad phase to find all that counts (m).
  [[nodiscard]] double search(std::uint32_t patch, double reach) const { return std::max(reach, depth_[patch]); }
  /// Is this triangle never held against this vertex? Never so between two surfaces.
  [[nodiscard]] bool excluded(int vertex, std::size_t triangle) const;
  /// The same of up to eight that follow one another. @param rest their places at rest
  /// @return those that are not excluded, a bit each
  [[nodiscard]] std::uint32_t notExcluded(int vertex, std::size_t first, std::size_t count,
                                          const TriangleLanes& rest) const;

 private:
  friend class SurfaceSearch;
  friend void patchesInPlay(const SurfacePair& pair, const SurfaceDisplacement& a, const SurfaceDisplacement& b,
                            double reach, std::vector<std::uint32_t>& out);
  void measureRest(const ContactSurface& a, const ContactSurface& b);
  [[nodiscard]] bool wasBehind(std::size_t vertex, std::size_t triangle, double squared) const;
  [[nodiscard]] std::span<const std::uint32_t> listed(std::size_t vertex) const {
    return {excluded_.data() + excludedStart_[vertex], excludedStart_[vertex + 1] - excludedStart_[vertex]};
  }

  bool self_ = false;
  std::vector<Vec3> restA_;
  std::vector<Vec3> restB_;
  std::vector<Index3> triangle_;  ///< of b
  std::vector<Vec3> normal_;      ///< of those at rest, as long as twice the area; of a surface with itself (m^2)
  std::vector<double> offset_;
  std::vector<double> depth_;  ///< per patch: deepestOverlap less the least offset of its vertices
  std::vector<std::size_t> excludedStart_;
  std::vector<std::uint32_t> excluded_;
  // Unsigned distances at rest from what is not excluded, at most `known` (m): of each vertex, and of each patch of
  // vertices from each patch of triangles.
  std::vector<double> vertexDistance_;
  std::vector<double> patchDistance_;
  std::vector<double> leastDistance_;  ///< of each patch of vertices: from all patches of triangles
  std::size_t patchesB_ = 0;
};

/// How nodes have been displaced since rest: their mean, and how far the farthest is from it (m).
struct Displacement {
  Vec3 mean = Vec3::Zero();
  double spread = -1.0;  ///< negative: not asked for yet
};

/// That of a surface: worked out once for all pairs that it is part of.
struct SurfaceDisplacement {
  std::vector<Displacement> patch;  ///< of the nodes that belong to each
  Displacement whole;
};
void measureDisplacement(const ContactSurface& surface, std::span<const Vec3> position, std::span<const Vec3> rest,
                         SurfaceDisplacement& out);

/// The patches of `a` that can be in contact at all, ascending: the broad phase need be asked for these alone (and the
/// answer's queries numbered by them). The others have not been displaced enough against the whole of `b`.
/// @pre displacements are from the pair's rest
void patchesInPlay(const SurfacePair& pair, const SurfaceDisplacement& a, const SurfaceDisplacement& b, double reach,
                   std::vector<std::uint32_t>& out);

/// Finds the contacts of `a`'s vertices with `b`'s triangles (for a surface with itself, both are the same).
///
/// Of each pair (patch of vertices, patch of triangles) only the vertex with the least gap is kept, ties to the lower
/// number: rows stay few, and every region that touches has one.
/// Most pairs are settled without a look at their triangles: what at rest was d apart, and has since been displaced by
/// at most m against one another, is at least d - m apart and on the side where it was. The answer is the same.
/// @param pairs query: patch of a, leaf: patch of b, sorted by query: from a broad phase over b's patches, queried with
/// a's patch boxes grown by pair.search()
/// @param reach contacts with a gap of this or more are left out (m)
/// @param memory of this pair alone, from step to step: makes it cheap where surfaces are far from rest, and never
/// changes the answer; may be null
/// Results are appended in order of their keys.
void surfaceContacts(const SurfacePair& pair, const ContactSurface& a, std::span<const Vec3> positionA,
                     const ContactSurface& b, std::span<const Vec3> positionB, std::span<const BroadPhase::Pair> pairs,
                     double reach, std::vector<VertexContact>& out, NearTriangles* memory = nullptr);

}  // namespace calot
