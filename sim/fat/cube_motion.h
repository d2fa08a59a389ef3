// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of fat for carving.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/carving/carve.h"
#include "sim/fat/fat_model.h"

namespace calot {

/// Lattice nodes move with the trilinear maps of their cubes. Nodes of an empty cube next to a remaining one are
/// carved as part of the latter, one cell beyond it: they are outside and only determine where the surface lies
/// between them and the inside.
class CubeMotion final : public TissueMotion {
 public:
  /// @param model outlives this
  explicit CubeMotion(const FatModel& model);

  /// Chooses the boxes that a stroke can change.
  /// @param now, before positions of the solid's nodes at the end and the beginning of the stroke (m, W);
  /// both outlive the stroke
  /// @param fill per cube; 0: empty
  /// @param depth as for carve() (m)
  void choose(std::span<const SweptCapsule> tool, std::span<const Vec3> now, std::span<const Vec3> before,
              std::span<const double> fill, double depth);
  [[nodiscard]] std::span<const NodeBox> boxes() const { return box_; }

  void fillLanes(std::size_t box, const Index3& first, int count, NodeLanes& out) const override;

 private:
  /// Distance between the bounds of tool and cube beyond which the cube is not affected (m).
  struct Reach {
    double depth = 0.0;  ///< of the carving, in W
    double beyond[3]{};  ///< greatest length of a cell along each axis
  };
  [[nodiscard]] Reach reachOf(const Index8& corner, double depth) const;
  void add(int cube, const Box& tool, const Reach& reach, std::span<const double> fill);

  const FatModel& model_;
  std::span<const Vec3> now_;
  std::span<const Vec3> before_;
  std::vector<NodeBox> box_;
  std::vector<std::int32_t> cube_;  ///< of each box
};

}  // namespace calot
