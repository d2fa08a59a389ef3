// SPDX-License-Identifier: GPL-3.0-or-later
// How fat moved, as carving asks for it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/carving/carve.h"
#include "sim/fat/fat_model.h"

namespace calot {

/// Lattice nodes go where the trilinear maps of their cubes take them. Nodes next to a cube that is there, in one that
/// is not, are carved as part of the former, a cell beyond it: they are outside, and only say where between them and
/// the inside the surface runs.
class CubeMotion final : public TissueMotion {
 public:
  /// @param model outlives this
  explicit CubeMotion(const FatModel& model);

  /// Chooses the boxes that a stroke can change.
  /// @param now, before nodes of the solid at both ends of the stroke (m, W); both outlive the stroke
  /// @param fill per cube; those of 0 are not there
  /// @param depth as for carve() (m)
  void choose(std::span<const SweptCapsule> tool, std::span<const Vec3> now, std::span<const Vec3> before,
              std::span<const double> fill, double depth);
  [[nodiscard]] std::span<const NodeBox> boxes() const { return box_; }

  void place(std::size_t box, const Index3& first, int count, NodeLanes& out) const override;

 private:
  /// How far the tool's bounds must be from a cube's for nothing of it to be reached (m).
  struct Reach {
    double depth = 0.0;  ///< of the carving, in W
    double beyond[3]{};  ///< a cell's length along each axis, at most
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
