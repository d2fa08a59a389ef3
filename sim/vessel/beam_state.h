// SPDX-License-Identifier: GPL-3.0-or-later
// State of vessels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/math/linear.h"
#include "sim/vessel/beam_model.h"

namespace calot {

/// Cause of an element's parting. A parted element transmits no force; its remains stay on its two nodes.
enum class Parting : std::uint8_t { none, cut, torn, burned };

struct BeamState {
  std::vector<Vec3> position;         ///< of the nodes in W (m)
  std::vector<Quat> orientation;      ///< of the nodes in W, unit
  std::vector<Vec3> velocity;         ///< (m/s)
  std::vector<Vec3> angularVelocity;  ///< in W (rad/s)
  std::vector<Parting> parting;       ///< per element
  std::vector<double> partedAt;       ///< per element: parting position as a share of its length from its first node
  std::vector<double> peakStrain;     ///< per element: largest stretch so far
  std::vector<double> exposure;       ///< per station: cautery of the wall so far (s)
  std::vector<double> charring;       ///< per station: coagulation so far (s)
  /// Per element: stiffness added by clips, in multiples of its own; 0 without clips.
  std::vector<double> sleeve;
  std::vector<Vec3> sleeveStretch;  ///< R_m^T d / L at which the sleeves are free of force
  std::vector<Vec3> sleeveBend;     ///< P at which they are free of force
  /// Clips in the order in which they were set. They are attached to the wall: positions are arc lengths at rest.
  std::vector<std::uint32_t> clipBranch;
  std::vector<double> clipPlace;  ///< middle of the clip (m)
  std::vector<double> clipWidth;  ///< along the vessel (m)
  std::vector<double> clipRoll;   ///< direction in which it flattens, about z of the branch's frame there, from x (rad)
  std::vector<double> clipClosure;   ///< 0 open to 1 closed
  std::vector<double> clipEnclosed;  ///< share of the flattened section between its legs, 1: all of it
  std::uint32_t quietSteps = 0;      ///< consecutive steps without contact and below the sleeping speed
  double maxDisplacement =
      0.0;  ///< from the reference configuration (m); stored because sleeping vessels do not recompute it

  [[nodiscard]] std::size_t clips() const { return clipPlace.size(); }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("position", self.position);
    visit("orientation", self.orientation);
    visit("velocity", self.velocity);
    visit("angularVelocity", self.angularVelocity);
    visit("parting", self.parting);
    visit("partedAt", self.partedAt);
    visit("peakStrain", self.peakStrain);
    visit("exposure", self.exposure);
    visit("charring", self.charring);
    visit("sleeve", self.sleeve);
    visit("sleeveStretch", self.sleeveStretch);
    visit("sleeveBend", self.sleeveBend);
    visit("clipBranch", self.clipBranch);
    visit("clipPlace", self.clipPlace);
    visit("clipWidth", self.clipWidth);
    visit("clipRoll", self.clipRoll);
    visit("clipClosure", self.clipClosure);
    visit("clipEnclosed", self.clipEnclosed);
    visit("quietSteps", self.quietSteps);
    visit("largestDisplacement", self.maxDisplacement);
  }
};

/// Reference state: no displacement, no velocity, whole, without clips, asleep.
BeamState restState(const BeamModel& model);

/// True if this is a valid state of the model (numbers of nodes and elements, equal lengths of lists, clips on
/// branches, positions in range)? Checks external data.
bool fits(const BeamModel& model, const BeamState& state);

/// A material point of a branch's centre line.
struct BeamPoint {
  std::size_t branch = 0;
  std::size_t element = 0;  ///< of the model
  double share = 0.0;       ///< of the element's length, from its first node, in [0, 1]
  double arcLength = 0.0;   ///< at rest, from the branch's start (m)
};

/// @param arcLength at rest (m), clamped to the branch
BeamPoint pointAt(const BeamModel& model, std::size_t branch, double arcLength);

/// Parts a vessel there if the element is whole. The share is clamped to [0.1, 0.9], so that both stumps have length.
/// @return false if it was already parted.
bool part(BeamState& state, const BeamPoint& where, Parting how);

/// Point of a branch closest to a point in W, on the chords of whole elements and the remains of parted ones.
/// @param[out] distance from the centre line (m)
BeamPoint closestPoint(const BeamModel& model, const BeamState& state, std::size_t branch, const Vec3& point,
                       double& distance);

}  // namespace calot
