// SPDX-License-Identifier: GPL-3.0-or-later
// Constant data of vessels: one or several tubes, branching or not, as geometrically exact beams (Simo 1985).
//
// A vessel is a chain of nodes, each with a position and an orientation (unit quaternion), joined by two-node
// elements with one integration point. The strains of an element are measured in its middle frame R_m, the geodesic
// mean of its nodes' orientations:
//   gamma = d / L - R_m a      d = x_b - x_a, L the rest length, a the rest axis in the middle frame (where the
//                              element is loaded at rest, `slack`: preload())
//   kappa = 4 / L (P - P_0)    P = tan(theta/4) n: relative rotation of the nodes by theta about n, in the middle frame
// and the energy is L/2 (E A |gamma|^2 + kappa . D kappa) with D = diag(EI, EI, GJ) about the axis. Both strains are
// invariant under rigid motions of any size and defined for every state, including collapsed and inverted elements,
// unlike strains in a frame that follows the chord.
//
// Shear has the stiffness E A of stretch, not k G A. Shear flexibility adds less than 1 % to the deflection of a vessel
// twenty times as long as thick; with k G A (a fifth to a third of E A) a linear law would lose stability in *tension*
// at strains of 0.2 to 0.3, where real vessels stretch and do not shear. So strains up to 1 are stable.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/math/linear.h"
#include "sim/math/symmetric_blocks.h"

namespace calot {

/// Circular section.
struct TubeSection {
  double outerRadius = 0.0;                   ///< m
  double wall = 0.0;                          ///< thickness (m); the outer radius or more: solid
  [[nodiscard]] double area() const;          ///< A of the wall (m^2)
  [[nodiscard]] double secondMoment() const;  ///< I about a diameter (m^4); the polar moment J is twice that
};

struct BeamMaterial {
  double young = 0.0;             ///< E (Pa)
  double poisson = 0.0;           ///< nu
  double density = 0.0;           ///< kg/m^3
  double massDamping = 0.0;       ///< Rayleigh alpha (1/s)
  double stiffnessDamping = 0.0;  ///< Rayleigh beta (s)
  double ultimateStrain = 1e300;  ///< stretch (length / rest length - 1) above which an element tears
};

/// Description of one tube.
struct BeamBranch {
  std::vector<Vec3> node;  ///< reference positions along the centre line (m), evenly spaced for best accuracy
  TubeSection section;
  BeamMaterial material;
  int join = -1;  ///< node of an earlier branch that this branch grows out of (its node[0] is there); -1: none
  bool fixedStart = false;  ///< first node constrained in position and orientation
  bool fixedEnd = false;    ///< last node constrained
};

/// `elements` + 1 nodes at equal arc lengths on the (uniform) Catmull-Rom curve through the points.
/// @pre at least two points, consecutive ones distinct
std::vector<Vec3> evenNodes(std::span<const Vec3> points, std::size_t elements);

/// A two-node element. Elements of one branch have consecutive indices.
struct BeamElement {
  int a = 0;  ///< nearer to the branch's start
  int b = 0;
  int branch = 0;
  double length = 0.0;        ///< L at rest (m)
  Vec3 axis = Vec3::Zero();   ///< unit, in the middle frame at rest
  Vec3 slack = Vec3::Zero();  ///< d / L, in the middle frame, at which it is free of force; unloaded: the axis
  Vec3 bend = Vec3::Zero();   ///< P_0, at which it is free of moments
  double stretching = 0.0;    ///< E A (N)
  double bending = 0.0;       ///< E I (N m^2)
  double twisting = 0.0;      ///< G J (N m^2)
  double damping = 0.0;       ///< beta (s)
};

class BeamModel {
 public:
  /// A branch as it was built.
  struct Branch {
    TubeSection section;
    BeamMaterial material;
    std::vector<int> node;          ///< from start to end; the first may belong to another branch
    std::vector<double> arcLength;  ///< arc length of each node at rest (m)
    std::size_t firstElement = 0;
    std::size_t firstStation = 0;
    std::size_t stations = 0;  ///< places at which cautery of the wall is kept, the same for any number of elements
    int join = -1;
    Quat startFrame =
        Quat::Identity();  ///< the branch's first frame in that of its first node (a rotation where it joins)

    [[nodiscard]] std::size_t elements() const { return node.size() - 1; }
    [[nodiscard]] double length() const { return arcLength.back(); }
    /// Between stations, which lie in the middles of equal parts (m).
    [[nodiscard]] double spacing() const { return length() / static_cast<double>(stations); }
    /// @param station of this branch, from 0
    [[nodiscard]] double arcLengthOf(std::size_t station) const {
      return (static_cast<double>(station) + 0.5) * spacing();
    }
  };

  /// @pre faultOf(branches) is empty
  explicit BeamModel(const std::vector<BeamBranch>& branches);

  /// Error of a description, naming branch and value; empty if valid.
  static std::string faultOf(const std::vector<BeamBranch>& branches);

  [[nodiscard]] std::size_t nodes() const { return rest_.size(); }
  [[nodiscard]] const std::vector<Vec3>& rest() const { return rest_; }
  /// Reference orientation of each node: z along the centre line, x and y transported along it without twist.
  [[nodiscard]] const std::vector<Quat>& restOrientation() const { return restOrientation_; }
  [[nodiscard]] const std::vector<BeamElement>& elements() const { return element_; }
  /// @pre the same elements, otherwise loaded (preload())
  void setElements(std::vector<BeamElement> elements) { element_ = std::move(elements); }
  [[nodiscard]] const std::vector<Branch>& branches() const { return branch_; }
  /// Stations of all branches together.
  [[nodiscard]] std::size_t stations() const { return branch_.back().firstStation + branch_.back().stations; }
  /// Distance between stations is at most this (m). Larger: the dose of a vessel's wall blurs; smaller: more State.
  /// Assumed: a sixth of what the hook's wire touches of a wall.
  static constexpr double maxSpacing = 0.00025;
  /// Neighbour towards the start, a smaller index; -1 for a node where a tree starts.
  [[nodiscard]] std::span<const int> parents() const { return parent_; }
  /// Element between a node and its parent; -1 at a root.
  [[nodiscard]] int elementBefore(std::size_t node) const { return elementBefore_[node]; }
  [[nodiscard]] bool fixed(std::size_t node) const { return fixed_[node]; }
  /// Lumped masses (kg): half of each element at the node.
  [[nodiscard]] const std::vector<double>& mass() const { return mass_; }
  /// Lumped rotary inertias (kg m^2), isotropic with the value about the axis: exact in torsion, with an error of
  /// second order in radius / wavelength in bending, and without gyroscopic terms.
  [[nodiscard]] const std::vector<double>& inertia() const { return inertia_; }
  /// Rayleigh alpha of each node (1/s): mean over its elements by mass.
  [[nodiscard]] const std::vector<double>& massDamping() const { return massDamping_; }
  /// Arc lengths of a branch where other branches meet it or it meets them (m), ascending.
  [[nodiscard]] std::vector<double> junctions(std::size_t branch) const;

 private:
  void addNode(const Vec3& position, const Quat& orientation, int parent, bool fixed);

  std::vector<Vec3> rest_;
  std::vector<Quat> restOrientation_;
  std::vector<int> parent_;
  std::vector<int> elementBefore_;
  std::vector<bool> fixed_;
  std::vector<double> mass_, inertia_, massDamping_;
  std::vector<BeamElement> element_;
  std::vector<Branch> branch_;
};

// Loads of vessels in the reference configuration: their stiffness in the reference configuration, and the loads of
// their elements there.

/// Adds the stiffness of all elements (stiffnessOf(), sim/vessel/beam_state.h) in the reference configuration.
/// @param factor of all of it
/// @param row per node: the row of its place (N/m), followed by that of its rotation about W's axes (N m); -1: fixed
void addStiffness(const BeamModel& model, double factor, std::span<const int> row, SymmetricBlocks& matrix);

/// Loads each element as a motion from the reference configuration by these displacements (m) and rotations (rad)
/// would, to first order, without moving it: the configuration that is free of stress lies that far from where it is
/// drawn. The loads are measured in the elements' frames and turn with them.
/// @param displacement, rotation per node
void preload(BeamModel& model, std::span<const Vec3> displacement, std::span<const Vec3> rotation);

}  // namespace calot
