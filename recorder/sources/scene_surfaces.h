// SPDX-License-Identifier: GPL-3.0-or-later
// Geometric queries of sources on the organs at rest: distances, obstacles and lines of sight.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sim/geometry/surface_distance.h"
#include "sim/scene/description.h"

namespace calot::recorder {

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
  std::vector<Box> bounds_;
};

}  // namespace calot::recorder
