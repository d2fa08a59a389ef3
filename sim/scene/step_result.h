// SPDX-License-Identifier: GPL-3.0-or-later
// What a step tells the world: the versioned contract (stepResultVersion) on which analytics and pictures stand.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/math/linear.h"
#include "sim/scene/samples.h"

namespace calot {

/// In the order of their numbers, which are stored in recordings and never reused. Structures: organs, then vessels, in
/// the scene's order.
enum class EventKind : std::uint16_t {
  contactBegin = 1,        ///< subject: structure; value: first normal force (N)
  contactEnd = 2,          ///< subject: structure; value: how long it lasted (s)
  instrumentExchange = 3,  ///< subject: new InstrumentKind; value: old InstrumentKind
  outOfWorkspace = 4,      ///< the sample left the scene's workspace and was clamped; value: distance outside (m)
  sampleInvalid = 5,       ///< the source had no measurement from here; the last pose is held
  sampleValid = 6,         ///< measurements are back; value: how long they were missing (s)
  solverMiss = 7,          ///< subject: structure; value: relative residual above the scene's tolerance
  contactMiss = 8,         ///< value: residual of the contact problem above the scene's tolerance
  graspBegin = 9,          ///< jaws closed on tissue; subject: structure; value: jaw opening (rad)
  graspEnd = 10,           ///< tissue let go; subject: structure; value: how long it was held (s)
  graspSlip = 11,          ///< held tissue begins to slip; subject: structure; value: pull (N)
  tissueTear = 12,         ///< held tissue tore out of the jaws; subject: structure; value: pull (N)
  // 13 to 15 were never given out: 16 was taken first, by the live loop, and later kinds went on from 17.
  clockStretched = 16,   ///< not the core's: the tick clock waited, lag over 100 ms; value: in this step (s)
  strandsBurned = 17,    ///< strands of connective tissue burned through; subject: tissue; value: share of the bed
  strandsTorn = 18,      ///< strands of connective tissue tore; subject: tissue; value: share of the bed
  connectiveFreed = 19,  ///< the last strand is gone; subject: tissue; value: share of the bed that is residue
  vesselTorn = 20,       ///< a vessel tore; subject: structure; value: stretch
  clipSet = 21,          ///< subject: structure; value: share of the flattened vessel between the clip's legs
  clipHalfOn = 22,       ///< beside clipSet: it does not enclose the whole vessel; value: as there
  clipOnClip = 23,       ///< beside clipSet: it overlaps another clip; value: by how much (m)
  clipTooNear = 24,      ///< beside clipSet: too near to another clip, a junction or an edge; value: gap (m)
  clipDropped = 25,      ///< an applier closed on nothing and lost its clip; value: clips left
  vesselCut = 26,        ///< scissors parted a vessel; subject: structure; value: arc length from its start (m)
  cutOpen = 27,          ///< beside vesselCut, vesselBurned, vesselTorn: it leaks; value: 1 start, 2 end, 3 both sides
  cutThroughClip = 28,   ///< beside vesselCut: within the width of a clip; value: as there
  vesselBurned = 29,     ///< cautery parted a vessel; subject: structure; value: as vesselCut
  organPerforated = 30,  ///< cautery or a tear opened an organ; subject: structure; value: cautery there (s), 0 if torn
  smoke = 31,            ///< subject: structure, or 100 + connective tissue, that was burned; value: energy (J)
  fatCameLoose = 32,     ///< fat that hangs on nothing any more left; subject: structure; value: its volume (m^3)
  tooFewClips = 33,     ///< beside vesselCut: a side has fewer clips than it should; subject: structure; value: missing
  criticalError = 34,   ///< a vessel to be spared was clipped or opened; subject: structure; value: kind of that event
  phaseBegin = 35,      ///< subject: the Phase that begins; value: the one before
  runaway = 36,         ///< something moves faster than fastestMotion, or is no number any more; value: speed (m/s)
  motionHeldBack = 37,  ///< tissue faster than it can move was held back; subject: structure; value: that speed (m/s)
};

/// Subject of smoke from connective tissue 0.
inline constexpr std::uint16_t smokeOfConnective = 100;

/// A fixed-size event. `hand` is 0, 1 or 255 (none).
struct Event {
  std::uint64_t step = 0;
  EventKind kind = EventKind::contactBegin;
  std::uint8_t hand = 255;
  std::uint16_t subject = 0;
  Vec3 position = Vec3::Zero();  ///< p_W (m)
  double value = 0.0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("step", self.step);
    visit("kind", self.kind);
    visit("hand", self.hand);
    visit("subject", self.subject);
    visit("position", self.position);
    visit("value", self.value);
  }
};

/// What the hook's current does. Numbers are stored in recordings.
enum class Cautery : std::uint8_t { off = 0, withoutContact = 1, onTissue = 2 };

/// One instrument at the end of a step.
struct HandResult {
  InstrumentKind instrument = InstrumentKind::none;
  Vec3 tipReal = Vec3::Zero();          ///< p_WI where the operator holds it, after port and workspace (m)
  Vec3 tipSimulated = Vec3::Zero();     ///< p_WI where contact lets it be (m)
  Quat orientation = Quat::Identity();  ///< q_WI of the simulated instrument
  double jaw = 0.0;                     ///< rad
  double insertion = 0.0;               ///< distance from port to simulated tip (m)
  Vec3 contactForce = Vec3::Zero();     ///< f_W, force of the organs on the instrument, reduced to its tip (N)
  double contactTorque = 0.0;           ///< of the organs about the shaft's axis (N m)
  std::uint32_t touching = 0;           ///< bit s: a force acts between this instrument and structure s
  std::vector<double> structureForce;   ///< per structure: sum of normal contact force magnitudes (N)
  std::uint32_t grasping = 0;           ///< bit s: the jaws hold structure s
  double graspForce = 0.0;              ///< pull on what the jaws hold (N)
  Cautery cautery = Cautery::off;       ///< of the hook
  std::uint32_t clips = 0;              ///< left in the clip applier
};

/// One organ at the end of a step.
struct OrganResult {
  double volume = 0.0;               ///< of the deformed tetrahedra (m^3)
  double largestDisplacement = 0.0;  ///< over its nodes, from rest (m)
  double largestSpeed = 0.0;         ///< over its nodes (m/s)
  double residual = 0.0;             ///< relative residual of the linear solve; 0 when asleep
  std::uint32_t iterations = 0;      ///< of the linear solve; 0 when asleep
  bool asleep = false;               ///< untouched and at rest: not solved in this step
  double charredArea = 0.0;          ///< of its skin at rest (m^2)
};

/// One vessel at the end of a step.
struct VesselResult {
  double largestStrain = 0.0;        ///< stretch (length / rest length - 1) of any whole element; 0 when asleep
  double largestTension = 0.0;       ///< pull in any whole element (N); 0 when asleep
  double largestDisplacement = 0.0;  ///< of any node of the vessels that it grows together with, from rest (m)
  std::uint32_t clips = 0;           ///< on it
  std::uint32_t partings = 0;        ///< places where it is cut, burned or torn through
  double charred = 0.0;              ///< most cautery at any spot, as a share of what parts it
  bool asleep = false;
};

/// One connective tissue at the end of a step, as shares of its bed's area.
struct ConnectiveResult {
  double attached = 0.0;
  double burned = 0.0;
  double torn = 0.0;              ///< hangs on the organs as residue
  double largestPull = 0.0;       ///< on any strand, per area (Pa)
  std::uint32_t hookTouches = 0;  ///< strands that the energised hook touched in this step
};

/// One body of fat at the end of a step.
struct FatResult {
  double volume = 0.0;               ///< that is left, at rest (m^3)
  double toClear = 0.0;              ///< the part of it inside the region that is to be cleared (m^3)
  double carved = 0.0;               ///< volume that the hook took in this step (m^3)
  double islands = 0.0;              ///< volume that came loose by that and left (m^3)
  double largestDisplacement = 0.0;  ///< over its nodes, from rest (m)
  double largestSpeed = 0.0;         ///< over its nodes (m/s)
  double residual = 0.0;             ///< relative residual of the linear solve; 0 when asleep
  std::uint32_t iterations = 0;      ///< of the linear solve; 0 when asleep
  bool asleep = false;
};

/// What an attempt is at. Numbers are stored in recordings.
enum class Phase : std::uint8_t { none = 0, identification = 1, clipping = 2, cutting = 3, dissection = 4, done = 5 };

/// How far the procedure is, in scenes that have one.
struct ProcedureResult {
  Phase phase = Phase::none;         ///< of this step; phases may recur
  std::uint8_t triangleCleared = 0;  ///< critical view of safety, 0 to 2 each, frozen at the first clip:
  std::uint8_t lowerThirdFreed = 0;  ///< (docs/procedure.md)
  std::uint8_t twoStructures = 0;    ///<
  bool criticalViewFrozen = false;
  double lowerThirdAttached = 0.0;   ///< share of the lower third of the bed that is still attached
  std::uint32_t errors = 0;          ///< so far
  std::uint32_t criticalErrors = 0;  ///< so far; one fails the attempt
};

/// The contact problem of a step.
struct ContactResult {
  std::uint32_t blocks = 0;       ///< places of contact and of hold
  std::uint32_t rows = 0;         ///< scalar constraints
  std::uint32_t iterations = 0;   ///< sweeps used
  std::uint32_t newtonSteps = 0;  ///< used where sweeps did not converge
  std::uint32_t passes = 0;       ///< how often the problem was posed
  double residual = 0.0;          ///< of its last solution: largest natural residual (m), sim/contact/contact_solver.h
  double error = 0.0;             ///< the same with the gaps that the forces really left (m)
  double violation = 0.0;         ///< largest violation that the forces had to undo (m)
  double largestDepth = 0.0;      ///< deepest point of an instrument inside an organ after the step (m), 0 if outside
  double pinchedDepth = 0.0;      ///< the same where tissue presses from two sides and leaves no room (m)
  double tissueDepth = 0.0;       ///< deepest overlap of organs, beyond that at rest, as the step found it (m)
};

/// Tissue and vessels do not move faster than this (m/s): hands reach 2, a stump that springs back 10. A step that
/// leaves them faster, or at places that are no numbers, has failed and says so: EventKind::runaway and miss::runaway.
inline constexpr double fastestMotion = 30.0;

/// Bits of StepResult::misses: a step that misses a tolerance says so.
namespace miss {
inline constexpr std::uint32_t solver = 1U << 0U;
inline constexpr std::uint32_t contact = 1U << 1U;
inline constexpr std::uint32_t speed = 1U << 3U;    ///< some tissue was held back: EventKind::motionHeldBack
inline constexpr std::uint32_t runaway = 1U << 2U;  ///< State is worth nothing from here on: the attempt is to end
}  // namespace miss

struct StepResult {
  std::uint64_t step = 0;  ///< n; the state after ticks [n T, (n + 1) T) with T ticks a step
  std::array<HandResult, handCount> hand;
  std::vector<OrganResult> organ;
  std::vector<ConnectiveResult> connective;
  std::vector<VesselResult> vessel;
  std::vector<FatResult> fat;
  ProcedureResult procedure;
  ContactResult contact;
  std::uint32_t misses = 0;
  std::vector<Event> events;
};

}  // namespace calot
