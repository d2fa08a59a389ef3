// SPDX-License-Identifier: GPL-3.0-or-later
// The 1 kHz tick, the only code that computes a device force. It solves the reduced complementarity problem of the last
// step (Saupin, Duriez and Cotin 2008, "Contact model for haptic medical simulations") at the hand's newest pose.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/contact/contact_solver.h"
#include "sim/instruments/instrument_shape.h"
#include "sim/math/fields.h"
#include "sim/math/linear.h"
#include "sim/scene/model.h"
#include "sim/scene/state.h"

namespace calot {

// Force of a real instrument's port on the hand: friction of the trocar's seal along the shaft, resistance of the
// abdominal wall to tilting it. Shown to the hand; no part of contact, of forces on structures or of State.

/// A port as the hand feels it. Zero: not at all.
struct PortModel {
  Vec3 port = Vec3::Zero();         ///< p_WP, pivot of the shaft (m)
  Vec3 neutralAxis = Vec3::Zero();  ///< unit, along which the wall holds the trocar by itself
  double trocarFriction = 0.0;      ///< largest friction along the shaft (N)
  double wallStiffness = 0.0;       ///< k, of the wall to tilting (N m/rad)
  /// Stiffness of a seal that sticks to the shaft (N/m): the hand's coupling stiffness, which the device renders
  /// stably. Assumed; more takes less of a stroke until it slips.
  double sealStiffness = 1000.0;

  [[nodiscard]] bool felt() const { return trocarFriction > 0.0 || wallStiffness > 0.0; }
};

/// Force on the hand at the tip (f_W, N).
/// Friction: Coulomb's, in Prandtl's form. The seal sticks to the shaft and is stretched by up to friction over
/// stiffness, then slips; so the force goes through zero continuously when the motion reverses, does not depend on the
/// noise of a speed, and never does work on the hand over a closed path.
/// Wall: torque k sin(tilt) about the port towards the neutral axis n, from the potential k (1 - n . a) with a the axis
/// of the shaft; as a force at the tip at distance L from the port, k (n - (n . a) a) / L. For small tilts k times
/// tilt.
/// @param seal distance of port and tip at which the seal is unstretched (m); moved where it slips; negative: here
/// @pre the tip is at least minInsertion from the port
Vec3 portForce(const PortModel& model, const Vec3& tip, double& seal);

/// The contact problem of one hand after a step, reduced to the instrument (frame I: tip and roll). With q the stretch
/// of the virtual coupling from the simulated instrument to the real one,
///   gap = free + t rate + T q + W lambda,  force on the instrument = T^T lambda,
/// T one row of four for each constraint, W the compliance of organs and coupling together, t the time since the step.
struct ContactSet {
  std::int64_t step = -1;          ///< step that produced it; -1: before the first
  Pose reference;                  ///< simulated instrument from which the stretch is measured
  std::vector<BlockKind> kind;     ///< blocks of rows
  std::vector<double> limit;       ///< of each block
  std::vector<ToolRow> direction;  ///< rows of T
  std::vector<double> free;        ///< m
  std::vector<double> rate;        ///< rate at which tissue motion opens the gaps (m/s)
  std::vector<double> compliance;  ///< W, row-major (m/N)
  std::vector<double> lambda;      ///< the step's own solution (N), warm start

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("step", self.step);
    visit("reference.position", self.reference.position);
    visit("reference.orientation", self.reference.orientation);
    visit("kind", self.kind);
    visit("limit", self.limit);
    visit("direction", self.direction);
    visit("free", self.free);
    visit("rate", self.rate);
    visit("compliance", self.compliance);
    visit("lambda", self.lambda);
  }
};

/// State of the tick from one to the next. Never part of State.
struct HapticState {
  Vec3 tip = Vec3::Zero();              ///< real tip of the newest measurement (m)
  Quat orientation = Quat::Identity();  ///< of the real instrument
  std::int64_t set = -1;                ///< step of the contact set that `lambda` belongs to
  std::uint32_t age = 0;                ///< ticks that used this set so far
  std::vector<double> lambda;           ///< N
  Vec3 force = Vec3::Zero();            ///< contact force of the last tick (N)
  double torque = 0.0;                  ///< about the axis (N m)
  Vec3 forceResidual = Vec3::Zero();    ///< decaying difference from the last change of sets (N)
  double torqueResidual = 0.0;          ///< N m
  double seal = -1.0;  ///< PortModel: where the trocar's seal is unstretched (m); negative: no tick yet

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("tip", self.tip);
    visit("orientation", self.orientation);
    visit("set", self.set);
    visit("age", self.age);
    visit("lambda", self.lambda);
    visit("force", self.force);
    visit("torque", self.torque);
    visit("forceResidual", self.forceResidual);
    visit("torqueResidual", self.torqueResidual);
    visit("seal", self.seal);
  }
};

/// True if the sizes of a set are consistent and its numbers finite. For data read from a file.
bool isConsistent(const ContactSet& set);
/// True if this haptic state fits this contact set.
bool isConsistent(const HapticState& state, const ContactSet& set);

/// Parameters of a hand for the tick.
struct HapticModel {
  double maxForce = 8.0;      ///< limit of the device (N)
  double maxStretch = 0.008;  ///< of the coupling at the tip: largest force over stiffness (m)
  std::uint32_t ticksPerStep = 10;
  std::uint32_t sweeps = 4;  ///< of the reduced problem, from the last tick's forces
  double tolerance = 1e-6;   ///< m
  PortModel port;            ///< felt beside the contact forces; nothing unless the scene says so
};

/// Largest stretch of the coupling about the shaft (rad).
inline constexpr double maxRollStretch = 0.5;

/// Bounded stretch of the virtual coupling, from the simulated instrument to the real one.
ToolRow couplingStretch(const Pose& simulated, const Pose& real, double maxStretch);

struct HapticForce {
  Vec3 force = Vec3::Zero();   ///< f_W on the hand (N)
  Vec3 torque = Vec3::Zero();  ///< about the tip, in W, along the shaft's axis (N m)
};

/// One tick. When the set changes, the difference between the forces of the old and the new one decays over the
/// following ticks, so that the force does not jump. Allocates only when a contact set has more rows than any before.
/// @pre takeSample() took this tick's sample
HapticForce hapticTick(const HapticModel& model, HapticState& state, const ContactSet& set);

/// Haptic state of a hand before the first tick.
HapticState initialHaptics(const State& state, std::size_t hand);

/// Takes one tick's sample: the real pose is the sample through workspace and port; held where the sample is no
/// measurement.
void takeSample(const Model& model, std::size_t hand, const InstrumentSample& sample, HapticState& haptics);

/// Limits of a hand's virtual coupling and device, and its port: the wall is at rest where the shaft is at the start.
HapticModel hapticModel(const Model& model, std::size_t hand);

}  // namespace calot
