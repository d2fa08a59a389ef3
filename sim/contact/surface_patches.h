// SPDX-License-Identifier: GPL-3.0-or-later
// The contact surface of a solid: triangles and their adjacency, grouped into patches, the leaves of the broad phase;
// features of a closed surface near a point: normals, sides and local minima of the distance.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/geometry/closest_point.h"
#include "sim/math/linear.h"

namespace calot {

/// Adjacency on a closed surface whose triangles change, computed on demand.
class SurfaceTopology {
 public:
  static constexpr std::size_t maxAround = 20;  ///< triangles at a node

  virtual ~SurfaceTopology() = default;
  /// Triangle across edge k.
  [[nodiscard]] virtual std::size_t across(std::size_t triangle, int k) const = 0;
  /// Triangles with this node as a corner, in an order fixed by the surface. @return their number
  virtual std::size_t around(int node, std::span<std::uint32_t, maxAround> out) const = 0;
};

/// Topology of a closed surface over the nodes of a solid: fixed (an organ) or changing (the remaining fat). Contact
/// code treats both alike except for triangle names: on a changing surface, names are such that a change elsewhere
/// leaves a contact's key unchanged.
class ContactSurface {
 public:
  struct Patch {
    std::size_t first = 0;  ///< triangles [first, last)
    std::size_t last = 0;
  };

  /// Scratch memory for adjacency that is computed on demand.
  struct Fan {
    std::array<std::uint32_t, SurfaceTopology::maxAround> triangle;
    std::array<int, 3 * SurfaceTopology::maxAround> node;
  };

  static constexpr std::size_t maxPatchTriangles = 64;

  /// Groups the triangles into patches of neighbours by recursive bisection of their rest centroids along the longest
  /// side (ties by index) into at most `maxPatchTriangles` each. Patches of a larger surface hold 32 to 64.
  /// @param triangles outward, closed manifold
  ContactSurface(std::span<const Vec3> rest, std::span<const Index3> triangles);

  /// A changing surface, empty until setPatches(). patchNodes(), patchOf(), nodes(), the calls without a Fan and
  /// SurfacePair do not support it.
  /// @param topology outlives this
  /// @param capacity bound of triangle indices, at most 2^30. Node indices are below 2^25
  ContactSurface(const SurfaceTopology& topology, std::size_t capacity)
      : topology_(&topology), triangle_(capacity, Index3::Zero()), name_(capacity, 0) {}

  /// Sets the triangles by patches, ascending within each; swaps the lists with those given.
  /// @param cornerStart per patch: start of its corners in `corner` (patchCorners()); then the end
  void setPatches(std::vector<Patch>& patches, std::vector<std::size_t>& cornerStart, std::vector<int>& corner) {
    patch_.swap(patches);
    patchCornerStart_.swap(cornerStart);
    patchCorner_.swap(corner);
  }
  /// @param name below 2^30, unique among the current triangles
  void setTriangle(std::size_t triangle, const Index3& corners, std::uint32_t name) {
    triangle_[triangle] = corners;
    name_[triangle] = name;
  }

  /// True for a changing surface.
  [[nodiscard]] bool changes() const { return topology_ != nullptr; }
  /// Name of a triangle in contact keys; its index if the surface is fixed.
  [[nodiscard]] std::uint64_t name(std::size_t triangle) const {
    return topology_ == nullptr ? triangle : name_[triangle];
  }

  /// By index. On a changing surface, only triangles in patches are valid.
  [[nodiscard]] const std::vector<Index3>& triangles() const { return triangle_; }
  [[nodiscard]] const std::vector<Patch>& patches() const { return patch_; }
  /// Node opposite to edge k (corners k and k + 1) in the neighbouring triangle.
  [[nodiscard]] int opposite(std::size_t triangle, int k) const {
    return topology_ == nullptr ? opposite_[triangle][k] : oppositeNow(triangle, k);
  }
  /// Triangle across edge k, -1 at a border.
  [[nodiscard]] int neighbourTriangle(std::size_t triangle, int k) const {
    return topology_ == nullptr ? beyond_[triangle][k] : static_cast<int>(topology_->across(triangle, k));
  }
  /// Triangles with this node as a corner, ascending.
  [[nodiscard]] std::span<const std::uint32_t> trianglesAround(int node) const {
    const auto n = static_cast<std::size_t>(node);
    return {around_.data() + aroundStart_[n], around_.data() + aroundStart_[n + 1]};
  }
  /// The same for every surface; on a changing one in the order of SurfaceTopology.
  [[nodiscard]] std::span<const std::uint32_t> trianglesAround(int node, Fan& fan) const {
    if (topology_ == nullptr) return trianglesAround(node);
    return {fan.triangle.data(), topology_->around(node, fan.triangle)};
  }
  /// Patch of a triangle.
  [[nodiscard]] std::uint32_t patchOf(std::size_t triangle) const { return patchOf_[triangle]; }
  /// Nodes of a patch, ascending. A surface node belongs to the first patch that has it as a corner.
  [[nodiscard]] std::span<const int> patchNodes(std::uint32_t patch) const {
    return {patchNode_.data() + patchNodeStart_[patch], patchNode_.data() + patchNodeStart_[patch + 1]};
  }
  /// Corners of a patch's triangles, ascending, each once.
  [[nodiscard]] std::span<const int> patchCorners(std::uint32_t patch) const {
    return {patchCorner_.data() + patchCornerStart_[patch], patchCorner_.data() + patchCornerStart_[patch + 1]};
  }
  /// Nodes that share a surface edge with this node, ascending.
  [[nodiscard]] std::span<const int> neighbours(int node) const {
    const auto n = static_cast<std::size_t>(node);
    return {neighbour_.data() + neighbourStart_[n], neighbour_.data() + neighbourStart_[n + 1]};
  }
  /// The same for every surface; on a changing one unordered and with repetitions.
  [[nodiscard]] std::span<const int> neighbours(int node, Fan& fan) const;
  /// Surface nodes, ascending.
  [[nodiscard]] const std::vector<int>& nodes() const { return node_; }

 private:
  [[nodiscard]] int oppositeNow(std::size_t triangle, int k) const;

  const SurfaceTopology* topology_ = nullptr;
  std::vector<Index3> triangle_;
  std::vector<std::uint32_t> name_;  ///< of a changing surface
  std::vector<Patch> patch_;
  std::vector<Index3> opposite_;
  std::vector<Index3> beyond_;
  std::vector<std::size_t> aroundStart_;
  std::vector<std::uint32_t> around_;
  std::vector<std::uint32_t> patchOf_;
  std::vector<std::size_t> patchNodeStart_;
  std::vector<int> patchNode_;
  std::vector<std::size_t> patchCornerStart_;
  std::vector<int> patchCorner_;
  std::vector<std::size_t> neighbourStart_;
  std::vector<int> neighbour_;
  std::vector<int> node_;
};

/// Bounds of each patch, grown by `margin` and rounded outward to float (docs/explanation/contact.md).
void patchBounds(const ContactSurface& surface, std::span<const Vec3> position, double margin, std::vector<Box>& out);

/// Lists the patches whose bounds changed, ascending, for BroadPhase::refit(). @pre sizes agree
void changedBounds(std::span<const Box> before, std::span<const Box> after, std::vector<std::uint32_t>& changed);

/// Outward unit normal of a triangle; zero if twice its area is below 1e-18 m^2.
Vec3 faceNormal(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle);

/// Outward pseudonormal of a feature, not of unit length: a face's normal, the sum of both normals at an edge, the
/// angle-weighted sum at a vertex (Baerentzen and Aanaes 2005). For a point whose nearest point of the surface lies on
/// this feature, (point - nearest) . pseudonormal is positive outside and negative inside.
Vec3 pseudonormal(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle,
                  TriangleFeature feature);

/// True if a feature's nearest point is a local minimum of the distance over the surface, so that no triangle
/// around it is nearer?
/// @param away vector from that point to the query point (m)
bool isLocalMinimum(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle,
                    TriangleFeature feature, const Vec3& away);

/// Key of a feature, independent of the triangle from which it was found. Bits 50 and 51: 1 face, 2 edge, 3 vertex.
/// Below: the triangle's name (ContactSurface::name()), the edge's nodes or the node.
std::uint64_t featureKey(const ContactSurface& surface, std::size_t triangle, TriangleFeature feature);

/// The nearest point of the given patches' triangles to p.
struct NearestPoint {
  std::size_t triangle = 0;
  PointTriangle point;
  bool found = false;
  bool inside = false;  ///< on the inner side of the nearest feature
};
/// @param limit maximum distance (m). Ties go to the triangle with the lower index.
NearestPoint nearestPoint(const ContactSurface& surface, std::span<const Vec3> position,
                          std::span<const std::uint32_t> patches, const Vec3& p, double limit);

}  // namespace calot
