// SPDX-License-Identifier: GPL-3.0-or-later
// A body of fat at work: all that follows from its State, and the stroke that changes it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/carving/carve.h"
#include "sim/carving/carved_surface.h"
#include "sim/carving/fill.h"
#include "sim/carving/islands.h"
#include "sim/fat/carved_contact.h"
#include "sim/fat/cube_motion.h"
#include "sim/fat/fat_model.h"
#include "sim/fat/fat_volume.h"

namespace calot {

/// What a stroke did.
struct FatStroke {
  bool changed = false;       ///< the field was written: State's part `carved` has to be hashed anew
  double removed = 0.0;       ///< volume, islands included (m^3)
  double islands = 0.0;       ///< of what came loose, to a cell (m^3)
  std::uint32_t nodes = 0;    ///< lattice nodes removed
  Vec3 where = Vec3::Zero();  ///< their mean place (m, W); meaningless without any
};

/// One for each State that is stepped. Nothing in it is State: after a restore rebuild() makes all of it anew, and then
/// two bodies go the same way bit for bit, whatever they did before.
///
/// A step: beginStep(); the caller moves the solid (SolidSolver with fill() and attachments made of ties()); stroke()
/// where an energised hook is near; place the contact surface anew.
class FatBody {
 public:
  /// @param model outlives this. The uncarved body.
  explicit FatBody(const FatModel& model);
  FatBody(const FatBody&) = delete;
  FatBody& operator=(const FatBody&) = delete;

  /// @return false where the state is not the model's (fits()): then all is as uncarved
  [[nodiscard]] bool rebuild(const FatState& state);

  /// Remembers where the tissue is: strokes of this step are swept relative to it.
  void beginStep(const FatState& state);
  /// Takes off what the tool's capsules sweep over, from where they were at the step's beginning to where they are, and
  /// what that cuts loose. Nodes of the solid that only empty cubes hold stop. @pre beginStep() of this step
  FatStroke stroke(FatState& state, std::span<const SweptCapsule> tool);

  [[nodiscard]] const FatModel& model() const { return model_; }
  /// Share of each cube that is there, for SolidSolver and SolidModel::volume().
  [[nodiscard]] std::span<const double> fill() const { return fill_; }
  /// Share of a tie (FatModel::allTies()) that is there: its nodes that are still inside.
  [[nodiscard]] double tieShare(std::size_t tie) const { return tieShare_[tie]; }
  /// How a node's answer to impulses differs from that at rest (RestCompliance): the rotation of the cubes that hold
  /// it, times a factor above one where fat has left around it. Compliance between a and b is about rotation(a) C_ab
  /// rotation(b)^T.
  [[nodiscard]] Mat3 rotation(const FatState& state, int node) const;

  /// The surface for contact; CarvedContact::place() maps it.
  [[nodiscard]] const CarvedContact& contact() const { return contact_; }
  [[nodiscard]] const CarvedSurface& surface() const { return surface_; }
  [[nodiscard]] const CarvedField& field() const { return field_; }
  [[nodiscard]] const FatVolume& volume() const { return volume_; }

  /// How often a stroke had to make room; zero in steady state.
  [[nodiscard]] std::size_t growths() const { return surface_.growths() + contact_.growths(); }

 private:
  void rebuildAll();
  void takeFill(std::span<const std::uint32_t> hexahedra);
  void measureTies(int cube);
  [[nodiscard]] Vec3 meanPlace(const FatState& state, std::uint32_t& nodes) const;

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
  std::vector<std::size_t> tieStart_;  ///< per cube: its ties in tieOfCube_
  std::vector<std::size_t> tieOfCube_;
};

}  // namespace calot
