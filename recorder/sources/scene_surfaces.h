// SPDX-License-Identifier: GPL-3.0-or-later
// Geometric queries of sources on the organs at rest: distances, obstacles and lines of sight.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sim/geometry/surface_distance.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// Triangles of a mesh that a segment may cross, by a hierarchy of boxes: without it, a performer's search for places
/// to touch takes the square of the number of triangles.
class SegmentSearch {
 public:
  explicit SegmentSearch(const TriangleMesh& mesh);

  /// Calls visit(t) for each triangle whose box the segment from a to b meets, and a few others, in no particular
  /// order.
  template <class Visit>
  void forEachNear(const Vec3& a, const Vec3& b, Visit&& visit) const {
    if (node_.empty()) return;
    std::vector<int> todo{0};
    while (!todo.empty()) {
      const Node& node = node_[static_cast<std::size_t>(todo.back())];
      todo.pop_back();
      if (!meets(node.box, a, b)) continue;
      if (node.right == 0) {
        for (int i = node.first; i < node.first + node.count; ++i) visit(order_[static_cast<std::size_t>(i)]);
      } else {
        todo.push_back(node.right);
        todo.push_back(static_cast<int>(&node - node_.data()) + 1);
      }
    }
  }

 private:
  struct Node {
    Box box;  ///< with a margin for rounding
    int first = 0, count = 0;
    int right = 0;  ///< 0: a leaf; the left child follows its parent
  };

  static bool meets(const Box& box, const Vec3& a, const Vec3& b);
  void build(const TriangleMesh& mesh, int first, int last);

  std::vector<int> order_;
  std::vector<Node> node_;
};

class SceneSurfaces {
 public:
  explicit SceneSurfaces(const SceneDescription& scene);

  /// Distance to the nearest organ surface (m), negative inside an organ.
  [[nodiscard]] double signedDistance(const Vec3& p) const;
  /// The same to one organ.
  [[nodiscard]] double signedDistance(std::size_t organ, const Vec3& p) const {
    return organs_[organ].signedDistance(p);
  }

  struct Hit {
    std::size_t organ = 0;
    double parameter = 0.0;  ///< in [0, 1] along the segment
    Vec3 point = Vec3::Zero();
  };
  /// First crossing of the segment from a to b with any organ's surface; the smallest organ index among equal ones.
  [[nodiscard]] std::optional<Hit> firstHit(const Vec3& a, const Vec3& b) const;

  [[nodiscard]] std::size_t organs() const { return organs_.size(); }
  [[nodiscard]] const TriangleMesh& mesh(std::size_t organ) const { return organs_[organ].mesh(); }

 private:
  std::vector<SurfaceDistance> organs_;
  std::vector<SegmentSearch> search_;
  std::vector<Box> bounds_;
};

}  // namespace calot::recorder
