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
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/broad_phase.h"
#include "sim/contact/surface_patches.h"
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
  /// Is this triangle never tested against this vertex? Always false between two surfaces.
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

}  // namespace calot
