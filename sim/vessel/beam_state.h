// SPDX-License-Identifier: GPL-3.0-or-later
// State of vessels: nodes, the centre line between them, and forces in their elements.
#pragma once

#include <array>
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

/// Side of the parting on which a point of a parted element lies.
enum class Stump : std::uint8_t { none, before, after };

/// Position and frame (z along the vessel towards its end, x and y across it) in W. In a whole element: a cubic
/// Hermite curve through the nodes, with their z axes times the chord's length as tangents, and blended frames; both
/// are free of kinks at nodes. In a parted element: the reference chord, fixed to the stump's node.
/// @pre where.element is of branch where.branch
Pose centreLine(const BeamModel& model, const BeamState& state, const BeamPoint& where, Stump stump = Stump::none);

/// Nodes that a point of the centre line depends on, with weights that sum to one.
struct BeamInfluence {
  std::array<int, 2> node{};
  std::array<double, 2> weight{};
  std::size_t count = 0;
};

/// A force on the wall acts on the centre line, distributed linearly over the element's nodes. Its moment about
/// the centre line (force times radius) is neglected: the surroundings constrain the vessel, and tools drag
/// rather than twist it.
BeamInfluence influenceOf(const BeamModel& model, const BeamPoint& where, Stump stump = Stump::none);

/// Side of the parting on which a point lies; none in a whole element.
Stump stumpAt(const BeamState& state, const BeamPoint& where);

// Frames along a centre line, in deterministic arithmetic.

/// q / |q|.
Quat normalised(const Quat& q);

/// (1 - t) a + t b, normalised, b with the sign nearer to a. For t = 1/2 this is the geodesic mean.
Quat blend(const Quat& a, const Quat& b, double t);

/// Rotation by the smallest angle from unit vector `from` to unit vector `to`; about some normal if they are opposite.
Quat minimalRotation(const Vec3& from, const Vec3& to);

/// A frame with this z axis (unit) whose x axis is as close as possible to the axis of W that is farthest from z.
Quat frameAlong(const Vec3& z);

/// Rotation of b relative to a about axis n by theta: tan(theta/4) n in W (modified Rodrigues parameters; at most 1).
Vec3 quarterTangent(const Quat& a, const Quat& b);

/// q rotated about the vector w in W by the angle whose tangent is |w|: one step of rotation. A rod d whose end
/// moves along a straight line by w x d rotates by exactly that angle, so that positions and orientations stay
/// consistent in large steps.
Quat rotated(const Quat& q, const Vec3& w);

// One element: strains, forces and the stiffness of a step. Internal to this folder.

/// Strains of one element, all in W.
struct BeamStrain {
  Vec3 chord = Vec3::Zero();     ///< d (m)
  Vec3 axis = Vec3::Zero();      ///< R_m a
  Vec3 rotation = Vec3::Zero();  ///< R_m P
  Vec3 force = Vec3::Zero();     ///< n: acts on node a along it and on node b against it (N)
  Vec3 moment = Vec3::Zero();    ///< m: acts on node a along it and on node b against it, besides the moment of n (N m)
  double bendRate = 0.0;         ///< 1 + |P|^2: d kappa = bendRate / L R_m^T (w_b - w_a)
  double stretch = 0.0;          ///< |d| / L - 1
  double tension = 0.0;          ///< n along the axis, positive in tension (N)
};

BeamStrain strainOf(const BeamElement& element, const BeamState& state, std::size_t index);

/// With v and w the velocities and angular velocities of the nodes, the material stores and dissipates energy through s
/// = v_b - v_a + G_a w_a + G_b w_b  and  w_b - w_a:
///   force on b: -c s,  moment on a: -G_a^T c s + D (w_b - w_a),  moment on b: -G_b^T c s - D (w_b - w_a).
/// This Gauss-Newton stiffness is positive semidefinite and vanishes for rigid motions. `string` is the only
/// geometric term included: the transverse stiffness of a chord in tension. The other terms of the exact Hessian
/// are at most as large as those included, and the implicit step is stable as long as its matrix has more than
/// half the true stiffness.
struct BeamStiffness {
  Mat3 ga = Mat3::Zero();
  Mat3 gb = Mat3::Zero();
  Mat3 bend = Mat3::Zero();    ///< D (N m)
  Mat3 across = Mat3::Zero();  ///< 1 - axis axis^T
  double stretch = 0.0;        ///< c (N/m)
  double string = 0.0;         ///< N/m, of `across`
};

BeamStiffness stiffnessOf(const BeamElement& element, const BeamStrain& strain, double sleeve);

// Clips on vessels: how one sits, and what a cut opens. Nothing here refuses: whatever a hand can do can be done; the
// results describe it, and events are the caller's.
//
// Distances are arc lengths at rest along one branch, so pulling on a vessel changes none of it. Clips on another
// branch are not looked for.

/// A clip about to close around a vessel.
struct ClipAttempt {
  BeamPoint point;     ///< middle of the clip
  double width = 0.0;  ///< along the vessel (m)
  double legs = 0.0;   ///< from the crotch to the tips of its legs (m)
  double depth =
      0.0;            ///< of the centre line: distance from the crotch towards the tips (m), negative behind the crotch
  double roll = 0.0;  ///< direction in which it flattens, about z of centreLine() there, from x (rad)
  double closure = 1.0;  ///< 0 open to 1 closed
};

/// Seat of a clip, as facts: faults are judged elsewhere.
struct ClipSeat {
  static constexpr double none = 1e300;

  double enclosed = 0.0;      ///< share of the flattened section (its width is pi r) between the legs, 0 to 1
  bool missed = false;        ///< nothing between the legs
  int clip = -1;              ///< nearest clip on the same piece; -1: none
  double clipGap = none;      ///< to its edge, negative where they overlap (m)
  double junctionGap = none;  ///< to the nearest junction on the same piece, negative across it (m)
  double endGap = none;       ///< to the nearest end of the piece, parted or not, negative beyond it (m)
};

ClipSeat clipSeat(const BeamModel& model, const BeamState& state, const ClipAttempt& attempt);

/// Sets a clip: it pinches the tube and, over its width, lets it neither stretch nor bend (fifty times as stiff,
/// without force in the shape that the vessel has now). Its own mass is left out. @param enclosed of clipSeat(), above
/// 0
void setClip(const BeamModel& model, BeamState& state, const ClipAttempt& attempt, double enclosed);

/// True if this clip closes the lumen: it encloses all of the section and is closed to at least 95 %.
bool closes(const BeamState& state, std::size_t clip);

/// Flattening of the tube at a point: 0 round to 1 (walls touching), and its direction.
struct Pinch {
  double amount = 0.0;
  double roll = 0.0;  ///< of the clip that flattens most there
};

/// Flat over the width of a clip, round again one and a half radii beside it (smoothstep).
Pinch pinchAt(const BeamModel& model, const BeamState& state, std::size_t branch, double arcLength);

/// Half the thickness and half the width of a section (m): r and r when round; the wall's thickness and pi r / 2 when
/// flat (the girth stays about the same).
struct PinchedSection {
  double thin = 0.0;
  double wide = 0.0;
};
PinchedSection pinchedSection(const TubeSection& section, double amount);

/// Ends that a cut opens, and the clips between which it lies. "Before" is towards the branch's start, "after" towards
/// its end.
struct CutSides {
  int clipBefore = -1;  ///< nearest closing clip on the same piece; -1: none
  int clipAfter = -1;
  std::size_t before = 0;  ///< closing clips between the cut and the next parting, junction or end
  std::size_t after = 0;
  double gapBefore = 1e300;  ///< from the cut to that clip's edge (m)
  double gapAfter = 1e300;
  bool throughClip = false;  ///< within the width of a clip
  bool opensBefore = false;  ///< no clip closes this side: it leaks from the start or the next junction
  bool opensAfter = false;
};

/// To be asked before part(): the cut's own place must still be whole.
CutSides cutSides(const BeamModel& model, const BeamState& state, const BeamPoint& cut);

}  // namespace calot
