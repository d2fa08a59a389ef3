// SPDX-License-Identifier: GPL-3.0-or-later
// Results of a step: the versioned contract (stepResultVersion) on which judgement, analytics and pictures stand.
// Raw facts alone: what they mean for a grade is judged by an observer (sim/judgement).
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "sim/math/linear.h"
#include "sim/math/record.h"
#include "sim/scene/samples.h"
#include "sim/tissue/tissues.h"

namespace calot {

/// Facts of a step. In the order of their numbers, which are stored in recordings and never reused. Structures: organs,
/// then vessels, then fat, in the scene's order.
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
  clipHalfOn = 22,       ///< judged: it does not enclose the whole vessel; value: as of clipSet
  clipOnClip = 23,       ///< judged: it overlaps another clip; value: by how much (m)
  clipTooNear = 24,      ///< judged: too near to another clip, a junction or an edge; value: gap (m)
  clipDropped = 25,      ///< an applier closed on nothing and lost its clip; value: clips left
  vesselCut = 26,        ///< scissors parted a vessel; subject: structure; value: arc length from its start (m)
  cutOpen = 27,          ///< beside vesselCut, vesselBurned, vesselTorn: it leaks; value: 1 start, 2 end, 3 both sides
  cutThroughClip = 28,   ///< beside vesselCut: within the width of a clip; value: as there
  vesselBurned = 29,     ///< cautery parted a vessel; subject: structure; value: as vesselCut
  organPerforated = 30,  ///< cautery or a tear opened an organ; subject: structure; value: cautery there (s), 0 if torn
  smoke = 31,            ///< subject: structure, or 100 + connective tissue, that was burned; value: energy (J)
  fatCameLoose = 32,     ///< fat that hangs on nothing any more left; subject: structure; value: its volume (m^3)
  tooFewClips = 33,      ///< judged: a side of a cut has fewer clips than it should; value: missing
  criticalError = 34,    ///< judged: a critical error (sim/judgement); value: kind of the event that is one
  phaseBegin = 35,       ///< judged: subject: the Phase that begins; value: the one before
  runaway = 36,          ///< something moves faster than maxTissueSpeed, or is no number any more; value: speed (m/s)
  motionHeldBack = 37,   ///< tissue faster than it can move was held back; subject: structure; value: that speed (m/s)
  clipPlace = 38,        ///< beside clipSet: arc length of its middle from the vessel's start (m)
  clipGap = 39,          ///< beside clipSet, where the piece has another: distance of edges (m), below 0: overlap
  clipJunctionGap = 40,  ///< beside clipSet, where the piece has one: to the nearest junction (m), below 0: across it
  clipEndGap = 41,       ///< beside clipSet: to the nearest end of the piece (m), below 0: beyond it
  clipsTowardsStart = 42,  ///< beside vesselCut: clips that close the piece on the start's side
  clipsTowardsEnd = 43,    ///< the same on the end's side
  wallInjured = 44,        ///< cautery injured a vessel's wall, once a vessel; subject: structure; value: as vesselCut
  vesselSealed = 45,  ///< beside vesselBurned: coagulation closed the artery; subject: structure; value: as vesselCut
  instrumentsTouched = 46,  ///< one instrument began to touch the other; value: first normal force (N)
  retractionMore = 47,      ///< the assistant was asked for more; subject: structure; value: how far it now goes (m)
  retractionLess = 48,      ///< the same for less
  fatTorn = 49,             ///< a string of fat tore; subject: structure; value: its volume (m^3)
  pressedHard = 50,         ///< judged: an instrument begins to press too hard; subject: structure; value: force (N)
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

/// State of the hook's current. Numbers are stored in recordings.
enum class Cautery : std::uint8_t { off = 0, withoutContact = 1, onTissue = 2 };

/// One instrument at the end of a step.
struct HandResult {
  InstrumentKind instrument = InstrumentKind::none;
  Vec3 tipReal = Vec3::Zero();
  Vec3 tipSimulated = Vec3::Zero();
  Quat orientation = Quat::Identity();
  double jaw = 0.0;
  double insertion = 0.0;
  Vec3 contactForce = Vec3::Zero();
  double contactTorque = 0.0;
  std::uint32_t touching = 0;
  std::vector<double> structureForce;
  std::uint32_t grasping = 0;
  double graspForce = 0.0;
  Cautery cautery = Cautery::off;
  std::uint32_t clips = 0;
  double gripForce = 0.0;

  /// Bit s: a force acts between this instrument and structure s, or its jaws hold s.
  [[nodiscard]] std::uint32_t contacts() const { return touching | grasping; }
  /// All that it exerts on a structure (N): normal forces, and the pull on what its jaws hold.
  [[nodiscard]] double forceOn(std::size_t structure) const {
    return structureForce[structure] + ((grasping >> structure & 1U) != 0 ? graspForce : 0.0);
  }

  template <class Visit>
  static void fields(Visit&& visit) {
    visit(
        ResultField{"instrument", "", "", 1, "mounted: 0 none, 1 grasper, 2 hook, 3 clip applier, 4 scissors, 5 probe"},
        &HandResult::instrument);
    visit(ResultField{"tip_real", "m", "p_WI", 1, "tip where the operator holds it, after port and workspace"},
          &HandResult::tipReal);
    visit(ResultField{"tip_simulated", "m", "p_WI", 1, "tip where contact lets it be"}, &HandResult::tipSimulated);
    visit(ResultField{"orientation", "", "q_WI", 1, "of the simulated instrument, w x y z"}, &HandResult::orientation);
    visit(ResultField{"jaw", "rad", "", 1, "opening angle of the jaws"}, &HandResult::jaw);
    visit(ResultField{"insertion", "m", "", 1, "distance from port to simulated tip"}, &HandResult::insertion);
    visit(ResultField{"contact_force", "N", "f_W", 1,
                      "force of the organs and of the other instrument on the instrument, reduced to its tip"},
          &HandResult::contactForce);
    visit(ResultField{"touching", "", "", 1, "bit s: a force acts between this instrument and structure s"},
          &HandResult::touching);
    visit(ResultField{"organ_force", "N", "", 1,
                      "per structure (the organs first), sum of the magnitudes of normal forces"},
          &HandResult::structureForce);
    visit(ResultField{"contact_torque", "N m", "", 2, "torque of the same about the shaft's axis"},
          &HandResult::contactTorque);
    visit(ResultField{"grasping", "", "", 2, "bit s: the jaws hold structure s"}, &HandResult::grasping);
    visit(ResultField{"grasp_force", "N", "", 2, "pull on what the jaws hold"}, &HandResult::graspForce);
    visit(
        ResultField{"cautery", "", "", 3, "of the hook: 0 no current, 1 current without contact, 2 current on tissue"},
        &HandResult::cautery);
    visit(ResultField{"clips", "", "", 3, "left in the clip applier"}, &HandResult::clips);
    visit(ResultField{"grip_force", "N", "", 5,
                      "with which the jaws hold what they grasp: the pull at which it begins to slip; 0: nothing held"},
          &HandResult::gripForce);
  }
};

/// The contact problem of a step.
struct ContactResult {
  std::uint32_t blocks = 0;
  std::uint32_t rows = 0;
  std::uint32_t iterations = 0;
  std::uint32_t newtonSteps = 0;
  std::uint32_t passes = 0;
  double residual = 0.0;  ///< sim/contact/contact_solver.h
  double error = 0.0;
  double violation = 0.0;
  double maxDepth = 0.0;
  double pinchedDepth = 0.0;
  double tissueDepth = 0.0;
  bool instrumentsTouch = false;

  template <class Visit>
  static void fields(Visit&& visit) {
    visit(ResultField{"rows", "", "", 1, "scalar constraints"}, &ContactResult::rows);
    visit(ResultField{"iterations", "", "", 1, "sweeps used"}, &ContactResult::iterations);
    visit(ResultField{"residual", "m", "", 1, "natural residual of the last solution, largest block"},
          &ContactResult::residual);
    visit(ResultField{"largest_depth", "m", "", 1,
                      "deepest point of an instrument inside an organ or the other instrument; 0 outside"},
          &ContactResult::maxDepth);
    visit(ResultField{"blocks", "", "", 2, "contact points and grasped points"}, &ContactResult::blocks);
    visit(ResultField{"newton_steps", "", "", 2, "used where sweeps did not converge"}, &ContactResult::newtonSteps);
    visit(ResultField{"passes", "", "", 2, "how often the contact problem was posed"}, &ContactResult::passes);
    visit(ResultField{"error", "m", "", 2, "natural residual with the gaps that the forces really left"},
          &ContactResult::error);
    visit(ResultField{"violation", "m", "", 2, "largest violation that the forces had to undo"},
          &ContactResult::violation);
    visit(ResultField{"pinched_depth", "m", "", 2,
                      "as largest_depth, where tissue presses from two sides and leaves no way out"},
          &ContactResult::pinchedDepth);
    visit(
        ResultField{
            "tissue_depth", "m", "", 2,
            "deepest overlap of organs and vessels beyond that of the reference configuration, as the step found it"},
        &ContactResult::tissueDepth);
    visit(ResultField{"instruments_touch", "", "", 6, "1: a force acts between both instruments"},
          &ContactResult::instrumentsTouch);
  }
};

/// Tissue and vessels do not move faster than this (m/s): hands reach 2, a stump that springs back 10. A step that
/// leaves them faster, or at places that are no numbers, has failed and says so: EventKind::runaway and miss::runaway.
inline constexpr double maxTissueSpeed = 30.0;

/// Bits of StepResult::misses: a step that misses a tolerance says so.
namespace miss {
inline constexpr std::uint32_t solver = 1U << 0U;
inline constexpr std::uint32_t contact = 1U << 1U;
inline constexpr std::uint32_t speed = 1U << 3U;    ///< some tissue was held back: EventKind::motionHeldBack
inline constexpr std::uint32_t runaway = 1U << 2U;  ///< the State is invalid from here on: the attempt has to end
}  // namespace miss

/// Everything that a step reports, in the order of its groups: both hands, then what is in `Tissues`, the contact
/// problem, and what is the step's own.
struct StepResult : Tissues::Results {
  std::uint64_t step = 0;  ///< n; the state after ticks [n T, (n + 1) T) with T ticks a step
  std::array<HandResult, handCount> hand;
  ContactResult contact;
  std::uint32_t misses = 0;
  std::vector<Event> events;

  static constexpr std::array<ResultGroup, handCount> handGroup{
      ResultGroup{"/observables/left", 1, "one instrument; all of left, then all of right"},
      ResultGroup{"/observables/right", 1, ""}};
  static constexpr ResultGroup contactGroup{"/observables/contact", 1, "the contact problem"};
  static constexpr ResultField missesField{
      "misses", "", "", 1,
      "bit 0: solver above its tolerance; bit 1: contact above its tolerance; bit 2: the simulation ran away, nothing "
      "after it counts; bit 3: tissue that would have moved faster than it can was held back"};

  /// Calls `visit` for every field that StepResult has had since `version` or before, in the order of the recording's
  /// columns: what a version added stands behind what there was, and within a version groups stand in the order in
  /// which versions brought them. `visit` has
  ///   one(group, field, value)    of a group of which there is one
  ///   each(group, field, parts, member)  of a kind of tissue: `parts` is the vector, `member` points into one of them
  template <class Self, class Visit>
  static void fields(Self& self, std::uint32_t version, Visit&& visit) {
    for (std::uint32_t added = 1; added <= version; ++added) {
      for (std::uint32_t brought = 1; brought <= added; ++brought) addedTo(self, added, brought, visit);
    }
  }

  /// Same fields, bit for bit (a NaN is equal to itself, 0 and -0 differ), and the same events.
  [[nodiscard]] bool isSameAs(const StepResult& other) const;

 private:
  /// Fields that version `added` brought to the groups that version `brought` brought.
  template <class Self, class Visit>
  static void addedTo(Self& self, std::uint32_t added, std::uint32_t brought, Visit& visit) {
    const auto single = [&](const ResultGroup& group, auto& part) {
      if (group.since != brought) return;
      std::remove_cvref_t<decltype(part)>::fields([&](const ResultField& field, auto member) {
        if (field.since == added) visit.one(group, field, part.*member);
      });
    };
    for (std::size_t h = 0; h < handCount; ++h) single(handGroup[h], self.hand[h]);
    Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
      if (Kind::results.since != brought) return;
      Kind::Result::fields([&](const ResultField& field, auto member) {
        if (field.since == added) visit.each(Kind::results, field, Kind::resultsOf(self), member);
      });
    });
    single(contactGroup, self.contact);
    if (brought == 1 && added == missesField.since)
      visit.one(ResultGroup{"/observables", 1, ""}, missesField, self.misses);
  }
};

}  // namespace calot
