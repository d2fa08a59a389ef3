// SPDX-License-Identifier: GPL-3.0-or-later
// A body of fat: everything derived from its State, and the strokes that change it.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sim/carving/carve.h"
#include "sim/carving/carved_field.h"
#include "sim/carving/carved_surface.h"
#include "sim/carving/islands.h"
#include "sim/fat/carved_contact.h"
#include "sim/fat/cube_motion.h"
#include "sim/fat/fat_model.h"

namespace calot {

// Remaining volume of fat in the reference configuration: in total and by regions.

/// Each lattice node represents a cell's volume, of which the share clamp(1/2 - phi / cell, 0, 1) is inside: exact for
/// surfaces parallel to the axes, second-order accurate elsewhere. Shares are multiples of 2^-20 of a cell, so that
/// sums are exact and incremental updates equal a full pass. Derived from the field; never saved.
class FatVolume {
 public:
  explicit FatVolume(const FatModel& model);

  void rebuild(const CarvedField& field);
  /// Updates what the last stroke changed. Allocates nothing.
  void update(const CarvedField& field);

  /// m^3
  [[nodiscard]] double total() const { return unit_ * static_cast<double>(total_); }
  [[nodiscard]] double inRegion(std::size_t region) const { return unit_ * static_cast<double>(region_[region]); }

 private:
  void mark(std::uint32_t brick);
  void measure(const CarvedField& field, std::uint32_t brick);
  [[nodiscard]] BrickBits countedNodes(const CarvedField& field, std::uint32_t brick) const;

  const FatModel& model_;
  double unit_;                      ///< m^3
  std::vector<std::int64_t> brick_;  ///< (1 + regions) sums for each brick: all, then each region
  std::vector<std::uint8_t> marked_;
  std::vector<std::uint32_t> work_;
  std::int64_t total_ = 0;
  std::vector<std::int64_t> region_;
};

/// Outcome of a stroke.
struct FatStroke {
  bool changed = false;       ///< the field changed: the `carved` part of State must be rehashed
  double removed = 0.0;       ///< volume, islands included (m^3)
  double islands = 0.0;       ///< volume of islands, to the accuracy of a cell (m^3)
  std::uint32_t nodes = 0;    ///< lattice nodes removed
  Vec3 where = Vec3::Zero();  ///< their mean position (m, W); undefined without any
};

/// One per State that is stepped. Nothing in it is part of State: after a restore, rebuild() recomputes everything, and
/// two bodies then evolve identically, bit for bit, whatever their history.
///
/// A step: beginStep(); the caller moves the solid (SolidSolver with fill() and attachments made of ties()); stroke()
/// if an energised hook is near; the caller updates the contact surface's positions.
class FatBody {
 public:
  /// @param model outlives this. The uncarved body.
  explicit FatBody(const FatModel& model);
  FatBody(const FatBody&) = delete;
  FatBody& operator=(const FatBody&) = delete;

  /// @return false if the state is not valid for the model (fits()): the body is then uncarved
  [[nodiscard]] bool rebuild(const FatState& state);

  /// Stores the tissue's positions, relative to which strokes of this step are swept.
  void beginStep(const FatState& state);
  /// Removes what the tool's capsules sweep over between the step's beginning and end, and islands. Nodes of the solid
  /// that belong only to empty cubes are stopped. @pre beginStep() of this step
  /// @param rise by which the surface can recede in this step (m), as for carve()
  FatStroke stroke(FatState& state, std::span<const SweptCapsule> tool,
                   double rise = std::numeric_limits<double>::infinity());

  [[nodiscard]] const FatModel& model() const { return model_; }
  /// Remaining share of each cube, for SolidSolver and SolidModel::volume().
  [[nodiscard]] std::span<const double> fill() const { return fill_; }
  /// Remaining share of a tie (FatModel::allTies()): the share of its nodes that are still inside.
  [[nodiscard]] double tieShare(std::size_t tie) const { return tieShare_[tie]; }
  /// Correction of a node's compliance relative to the reference configuration (RestCompliance): the rotation of
  /// its cubes, times a factor above one where fat around it is gone. Compliance between a and b is
  /// approximately rotation(a) C_ab rotation(b)^T.
  [[nodiscard]] Mat3 rotation(const FatState& state, int node) const;

  /// The contact surface; CarvedContact::positions() maps it.
  [[nodiscard]] const CarvedContact& contact() const { return contact_; }
  [[nodiscard]] const CarvedSurface& surface() const { return surface_; }
  [[nodiscard]] const CarvedField& field() const { return field_; }
  [[nodiscard]] const FatVolume& volume() const { return volume_; }

  /// Number of reallocations in strokes; constant in steady state.
  [[nodiscard]] std::size_t growths() const { return surface_.growths() + contact_.growths(); }

 private:
  void rebuildAll();
  void updateFill(std::span<const std::uint32_t> hexahedra);
  void measureTies(int cube);
  [[nodiscard]] Vec3 meanPosition(const FatState& state, std::uint32_t& nodes) const;

  const FatModel& model_;
  CarvedField field_;
  Islands islands_;
  CarvedSurface surface_;
  CarvedContact contact_;
  Fill coarse_;
  FatVolume volume_;
  CubeMotion motion_;
  std::vector<Vec3> before_;
  std::vector<double> fill_;
  std::vector<double> tieShare_;
  std::vector<std::size_t> tieStart_;  ///< per cube: start of its ties in tieOfCube_
  std::vector<std::size_t> tieOfCube_;
};

}  // namespace calot
