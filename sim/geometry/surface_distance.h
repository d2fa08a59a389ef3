// SPDX-License-Identifier: GPL-3.0-or-later
// Exact signed distance to a triangle surface by a bounding volume hierarchy.
#pragma once

#include <array>
#include <vector>

#include "sim/geometry/closest_point.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot {

/// Method by which inside and outside are distinguished.
enum class InsideRule {
  automatic,     ///< pseudonormals when the surface is closed, manifold and consistently oriented, else winding number
  pseudonormal,  ///< angle-weighted pseudonormals (Baerentzen and Aanaes 2005): exact on closed manifolds without
                 ///< self-intersections
  winding,  ///< generalized winding number above one half (Jacobson et al. 2013), distant clusters as dipoles (Barill
            ///< et al. 2018): robust to holes and self-intersections, several times slower
};

/// Distances to a surface. Immutable after construction: queries allocate nothing and are thread-safe.
class SurfaceDistance {
 public:
  struct Closest {
    int triangle = -1;  ///< the smallest index among equally close triangles
    PointTriangle on;
  };

  /// @param mesh kept by copy; degenerate triangles are allowed, indices in range. O(n log^2 n).
  explicit SurfaceDistance(TriangleMesh mesh, InsideRule rule = InsideRule::automatic);

  /// Closest point of the surface to p. @pre the mesh has triangles, p is finite
  [[nodiscard]] Closest closest(const Vec3& p) const;
  /// The same, started at triangle `guess`: saves work when that one is near (the result of a neighbouring point).
  [[nodiscard]] Closest closest(const Vec3& p, int guess) const;

  /// Distance to the surface (m), negative inside.
  [[nodiscard]] double signedDistance(const Vec3& p) const;
  /// The same from a closest point found before.
  [[nodiscard]] double signedDistance(const Vec3& p, const Closest& closest) const;

  /// Generalized winding number of p: 1 inside, 0 outside a closed outward surface.
  [[nodiscard]] double windingNumber(const Vec3& p) const;

  /// Calls visit(t) for the triangles of every group whose box meets(box), in no particular order.
  template <class Meets, class Visit>
  void forEachNear(const Meets& meets, const Visit& visit) const {
    std::vector<int> waiting;
    if (!node_.empty()) waiting.push_back(0);
    while (!waiting.empty()) {
      const int at = waiting.back();
      waiting.pop_back();
      const Node& node = node_[static_cast<std::size_t>(at)];
      if (!meets(node.box)) continue;
      for (int i = node.first; i < node.first + node.count; ++i) visit(order_[static_cast<std::size_t>(i)]);
      if (node.count == 0) waiting.insert(waiting.end(), {node.right, at + 1});
    }
  }

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  [[nodiscard]] InsideRule rule() const { return rule_; }

 private:
  struct Node {
    Box box;
    int first = 0;               ///< into order_, for a leaf
    int count = 0;               ///< triangles of a leaf; 0 for an inner node
    int right = 0;               ///< an inner node's right child; the left one follows it
    Vec3 centre = Vec3::Zero();  ///< area-weighted centroid, for the dipole
    Vec3 dipole = Vec3::Zero();  ///< sum of area times normal (m^2)
    double radius = 0.0;         ///< of the sphere around `centre` that holds the box
  };

  int build(int first, int last, const std::vector<Vec3>& centroid);
  void search(const Vec3& p, Closest& best) const;
  void computePseudonormals();

  TriangleMesh mesh_;
  InsideRule rule_;
  std::vector<int> order_;
  std::vector<Node> node_;
  std::vector<Vec3> faceNormal_;                 ///< unit; zero for a degenerate triangle
  std::vector<std::array<Vec3, 3>> edgeNormal_;  ///< not unit: only signs are used
  std::vector<Vec3> vertexNormal_;
};

}  // namespace calot
