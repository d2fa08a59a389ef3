// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that changes. Each part lists its fields once (sim/math/fields.h).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "sim/math/random.h"
#include "sim/scene/description.h"
#include "sim/scene/model.h"
#include "sim/scene/samples.h"
#include "sim/scene/step_result.h"
#include "sim/tissue/tissues.h"

namespace calot {

// An assistant's retraction: where its pull is, and how a request moves it.

/// Variable part of a scene's retractions, one number of each. Positions are shares of
/// RetractionDescription::displacement; each move runs from one share to another along a cubic that goes on from the
/// speed at hand and ends at rest.
struct RetractionState {
  std::vector<double> from;   ///< share where the move began
  std::vector<double> speed;  ///< and its rate there (1/s)
  std::vector<double> goal;   ///< share where it ends
  std::vector<double> begun;  ///< when it began (s)
  std::vector<double> takes;  ///< how long it lasts (s), above 0

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("from", self.from);
    visit("speed", self.speed);
    visit("goal", self.goal);
    visit("begun", self.begun);
    visit("takes", self.takes);
  }
};

/// A retraction at one moment.
struct RetractionPlace {
  double share = 0.0;
  double rate = 0.0;  ///< of the share (1/s)
};

/// The pulls that the scene itself has: from nothing to the whole displacement.
RetractionState retractionsAtStart(const SceneDescription& scene);

/// One number of each retraction, and moves that take time?
bool fits(const SceneDescription& scene, const RetractionState& state);

/// @param which of the scene's retractions @param time of the attempt (s)
/// @pre fits(scene, state)
RetractionPlace retractionAt(const RetractionState& state, std::size_t which, double time);

/// True while it moves.
bool isMoving(const RetractionState& state, std::size_t which, double time);

/// The trainee asks for one stage more, or less: the goal moves by RetractionDescription::stage within 0 and `most`,
/// and the pull sets out for it from where it is, at the mean speed of the scene's own pull. At a limit nothing
/// changes.
void askForRetraction(const RetractionDescription& of, std::size_t which, double time, bool more,
                      RetractionState& state);

struct ClockState {
  std::uint64_t step = 0;  ///< the next step to compute
  Random random;           ///< seeded by the attempt's seed

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("step", self.step);
    visit("random.state", self.random.state);
    visit("random.increment", self.random.increment);
  }
};

struct CameraState {
  Vec3 position = Vec3::Zero();         ///< p_WC (m)
  Quat orientation = Quat::Identity();  ///< q_WC, unit
  std::uint64_t inputs = 0;             ///< XXH3-64 of the last step's camera samples, as they came

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("position", self.position);
    visit("orientation", self.orientation);
    visit("inputs", self.inputs);
  }
};

/// HandState::grasped of jaws that hold nothing.
inline constexpr std::uint32_t noStructure = 0xFFFFFFFFU;

struct HandState {
  InstrumentKind instrument = InstrumentKind::none;
  Vec3 realPosition = Vec3::Zero();              ///< tip after port and workspace (m)
  Quat realOrientation = Quat::Identity();       ///< unit
  Vec3 simulatedPosition = Vec3::Zero();         ///< tip where contact lets it be (m)
  Quat simulatedOrientation = Quat::Identity();  ///< unit
  double jaw = 0.0;                              ///< of the simulated instrument (rad)
  double realJaw = 0.0;                          ///< as the operator holds it (rad)
  std::uint8_t buttons = 0;
  bool valid = true;                         ///< the newest sample was a measurement
  bool outside = false;                      ///< the newest sample lay outside the workspace
  std::uint64_t invalidSince = 0;            ///< step in which measurements stopped
  std::uint32_t touching = 0;                ///< bit s: structure s
  std::vector<std::uint64_t> touchingSince;  ///< per structure: step in which the touch began
  std::vector<std::uint64_t> contactKey;     ///< the last step's contacts: where,
  std::vector<Vec3> contactForce;            ///< its normal and tangential parts (N); warm start of the next problem
  std::vector<std::uint64_t> dimpleKey;      ///< dimples that its capsules press: where (structure and capsule),
  std::vector<Vec3> dimple;                  ///< and how far the skin gave way beyond what its mesh shows (m)
  std::uint32_t grasped = noStructure;       ///< structure that the jaws hold
  bool jawsOpened = false;  ///< since they last closed: only then do they grasp, clip or cut when they close
  std::uint32_t clips = 0;  ///< left in the clip applier
  /// Tissue that the hook burns (a structure, or 100 + connective tissue), and energy put into it so far (J).
  std::uint32_t burning = noStructure;
  double burnedEnergy = 0.0;
  /// Places of its skin that the jaws hold: corners of a triangle and barycentric coordinates,
  std::vector<std::array<std::uint32_t, 3>> graspNode;
  std::vector<Vec3> graspWeight;
  std::vector<Vec3> graspPlace;  ///< where they are in frame I (m),
  std::vector<Vec3> graspForce;  ///< and f_W on the instrument there (N); warm start
  bool slipping = false;         ///< held tissue is being pulled through the jaws
  std::uint64_t graspSince = 0;  ///< step in which the hold began
  /// XXH3-64 of the last step's samples of this hand, as they came: a changed sample shows in its own step even where
  /// it moves nothing.
  std::uint64_t inputs = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("instrument", self.instrument);
    visit("realPosition", self.realPosition);
    visit("realOrientation", self.realOrientation);
    visit("simulatedPosition", self.simulatedPosition);
    visit("simulatedOrientation", self.simulatedOrientation);
    visit("jaw", self.jaw);
    visit("realJaw", self.realJaw);
    visit("buttons", self.buttons);
    visit("valid", self.valid);
    visit("outside", self.outside);
    visit("invalidSince", self.invalidSince);
    visit("touching", self.touching);
    visit("touchingSince", self.touchingSince);
    visit("contactKey", self.contactKey);
    visit("contactForce", self.contactForce);
    visit("dimpleKey", self.dimpleKey);
    visit("dimple", self.dimple);
    visit("grasped", self.grasped);
    visit("jawsOpened", self.jawsOpened);
    visit("clips", self.clips);
    visit("burning", self.burning);
    visit("burnedEnergy", self.burnedEnergy);
    visit("graspNode", self.graspNode);
    visit("graspWeight", self.graspWeight);
    visit("graspPlace", self.graspPlace);
    visit("graspForce", self.graspForce);
    visit("slipping", self.slipping);
    visit("graspSince", self.graspSince);
    visit("inputs", self.inputs);
  }
};

/// One instrument on the other.
struct InstrumentTouchState {
  bool touching = false;    ///< a touch has begun and not ended: since it began, no pause was long enough
  std::uint64_t begun = 0;  ///< step in which it began
  std::uint64_t last = 0;   ///< last step in which a force acted

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("touching", self.touching);
    visit("begun", self.begun);
    visit("last", self.last);
  }
};

/// Contact of tissue on tissue: the last step's places and forces, warm start of the next problem.
struct TissueContactState {
  std::vector<std::uint64_t> key;
  std::vector<double> force;  ///< N

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("key", self.key);
    visit("force", self.force);
  }
};

struct State : Tissues::States {
  /// Components that are written in every step stand before those of tissue.
  static constexpr std::size_t tissueFrom = 7;

  ClockState clock;
  CameraState camera;
  std::array<HandState, handCount> hand;
  InstrumentTouchState instruments;
  TissueContactState tissue;
  RetractionState retraction;

  /// Calls visit(part) for each component, in the order of DigestLayout::components.
  template <class Self, class Visit>
  static void components(Self& self, Visit&& visit) {
    ownComponents(self, [&](const char*, auto& part) { visit(part); });
    tissueComponents(self, [&](auto, const char*, std::size_t, auto& part) { visit(part); });
  }

  /// Calls visit(name, part) for the components that every scene has.
  template <class Self, class Visit>
  static void ownComponents(Self& self, Visit&& visit) {
    visit("clock", self.clock);
    visit("camera", self.camera);
    visit("hand.left", self.hand[0]);
    visit("hand.right", self.hand[1]);
    visit("instruments", self.instruments);
    visit("tissue", self.tissue);
    visit("retraction", self.retraction);
  }

  /// Calls visit(kind, prefix, index, part) for the others: each is named prefix and the name of the index-th of its
  /// kind.
  template <class Self, class Visit>
  static void tissueComponents(Self& self, Visit&& visit) {
    Tissues::forEach([&]<class Kind>(std::type_identity<Kind> kind, TissueId) {
      Kind::components(self,
                       [&](const char* prefix, std::size_t index, auto& part) { visit(kind, prefix, index, part); });
    });
  }
};

/// The state before the first step: organs at rest, instruments at home, camera in place.
State initialState(const Model& model, std::uint64_t seed);

/// Names of components and fields of a model's State. @pre the model has its tissue and scene
DigestLayout digestLayout(const Model& model);

/// Hashes every field of every component.
StateDigest digestOf(const State& state);

/// The same, component by component: a component that is not marked as written keeps its digest.
class IncrementalDigest {
 public:
  /// Forgets everything: the next update hashes all (after a restore).
  void reset() { valid_ = false; }
  /// @param written per component, in the order of DigestLayout::components
  const StateDigest& update(const State& state, const std::vector<bool>& written);

 private:
  StateDigest digest_;
  bool valid_ = false;
};

/// State as bytes, by its field lists.
std::vector<std::byte> saveState(const State& state);

/// Takes bytes of saveState(). @returns false, leaving `state` as it was, when they are not a State of this model
/// (missing or surplus bytes, other numbers of organs, nodes, elements or strands, numbers that are not finite or above
/// 1e6).
bool restoreState(const Model& model, std::span<const std::byte> bytes, State& state);

}  // namespace calot
