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

/// Stands for no structure: GraspState::structure of jaws that hold nothing, BurnState::tissue of a hook that burns
/// nothing.
inline constexpr std::uint32_t noStructure = 0xFFFFFFFFU;

// A hand, concern by concern.

/// A hand as it was last measured.
struct InputState {
  Vec3 position = Vec3::Zero();         ///< tip after port and workspace (m)
  Quat orientation = Quat::Identity();  ///< unit
  double jaw = 0.0;                     ///< as the operator holds it (rad)
  std::uint8_t buttons = 0;
  bool valid = true;               ///< the newest sample was a measurement
  bool outside = false;            ///< the newest sample lay outside the workspace
  std::uint64_t invalidSince = 0;  ///< step in which measurements stopped
  /// XXH3-64 of the last step's samples of this hand, as they came: a changed sample shows in its own step even where
  /// it moves nothing.
  std::uint64_t samples = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("position", self.position);
    visit("orientation", self.orientation);
    visit("jaw", self.jaw);
    visit("buttons", self.buttons);
    visit("valid", self.valid);
    visit("outside", self.outside);
    visit("invalidSince", self.invalidSince);
    visit("samples", self.samples);
  }
};

/// The simulated instrument: where contact lets it be.
struct InstrumentState {
  InstrumentKind kind = InstrumentKind::none;
  Vec3 position = Vec3::Zero();         ///< of the tip (m)
  Quat orientation = Quat::Identity();  ///< unit
  double jaw = 0.0;                     ///< rad
  bool jawsOpened = false;  ///< since they last closed: only then do they grasp, clip or cut when they close
  std::uint32_t clips = 0;  ///< left in the clip applier

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("kind", self.kind);
    visit("position", self.position);
    visit("orientation", self.orientation);
    visit("jaw", self.jaw);
    visit("jawsOpened", self.jawsOpened);
    visit("clips", self.clips);
  }
};

/// Tissue that the instrument presses on, and the warm start of the next contact problem.
struct TouchState {
  std::uint32_t structures = 0;          ///< bit s: structure s is touched
  std::vector<std::uint64_t> since;      ///< per structure: step in which the touch began
  std::vector<std::uint64_t> key;        ///< the last step's contacts: where,
  std::vector<Vec3> force;               ///< its normal and tangential parts (N)
  std::vector<std::uint64_t> dimpleKey;  ///< dimples that its capsules press: where (structure and capsule),
  std::vector<Vec3> dimple;              ///< and how far the skin gave way beyond what its mesh shows (m)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("structures", self.structures);
    visit("since", self.since);
    visit("key", self.key);
    visit("force", self.force);
    visit("dimpleKey", self.dimpleKey);
    visit("dimple", self.dimple);
  }
};

/// The hold of closed jaws: places of a structure's skin.
struct GraspState {
  std::uint32_t structure = noStructure;           ///< that the jaws hold
  std::vector<std::array<std::uint32_t, 3>> node;  ///< per place: corners of a triangle of its skin,
  std::vector<Vec3> weight;                        ///< barycentric coordinates,
  std::vector<Vec3> place;                         ///< where the jaws hold it in frame I (m),
  std::vector<Vec3> force;                         ///< and f_W on the instrument there (N); warm start
  bool slipping = false;                           ///< held tissue is being pulled through the jaws
  std::uint64_t since = 0;                         ///< step in which the hold began

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("structure", self.structure);
    visit("node", self.node);
    visit("weight", self.weight);
    visit("place", self.place);
    visit("force", self.force);
    visit("slipping", self.slipping);
    visit("since", self.since);
  }
};

/// The touch of an energised hook.
struct BurnState {
  std::uint32_t tissue = noStructure;  ///< that it burns: a structure, or smokeOfConnective + connective tissue
  double energy = 0.0;                 ///< put into it since smoke was last reported (J)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("tissue", self.tissue);
    visit("energy", self.energy);
  }
};

struct HandState {
  InputState input;
  InstrumentState instrument;
  TouchState touches;
  GraspState grasp;
  BurnState burn;

  /// Calls visit(name, part) for each concern: a component of State.
  template <class Self, class Visit>
  static void components(Self& self, Visit&& visit) {
    visit("input", self.input);
    visit("instrument", self.instrument);
    visit("touches", self.touches);
    visit("grasp", self.grasp);
    visit("burn", self.burn);
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

/// Changes of contact forces, and the motion of the tissue that followed them: what the contact problem has learned of
/// the tissue's compliance in the last steps. Contact points of all changes in a row, the oldest change first.
struct ResponseState {
  std::vector<std::uint32_t> points;  ///< per change: its contact points
  std::vector<std::uint64_t> key;     ///< per contact point, besides what its hand or kind is
  std::vector<Vec3> force;            ///< change of the force there (N)
  std::vector<Vec3> motion;           ///< of the tissue there, without instruments and dimples (m)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("points", self.points);
    visit("key", self.key);
    visit("force", self.force);
    visit("motion", self.motion);
  }
};

/// As many places, forces and motions as contact points?
bool fits(const ResponseState& state);

struct State : Tissues::States {
  ClockState clock;
  CameraState camera;
  std::array<HandState, handCount> hand;
  InstrumentTouchState instruments;
  TissueContactState tissue;
  ResponseState response;
  RetractionState retraction;

  /// Calls visit(part) for each component, in the order of DigestLayout::components.
  template <class Self, class Visit>
  static void components(Self& self, Visit&& visit) {
    ownComponents(self, [&](const char*, const char*, auto& part) { visit(part); });
    tissueComponents(self, [&](auto, const char*, std::size_t, auto& part) { visit(part); });
  }

  /// Calls visit(prefix, name, part) for the components that every scene has: each is named prefix and name. They count
  /// as written in every step, since they are small: hashing them costs less than finding out which of them changed.
  template <class Self, class Visit>
  static void ownComponents(Self& self, Visit&& visit) {
    visit("", "clock", self.clock);
    visit("", "camera", self.camera);
    HandState::components(self.hand[0], [&](const char* name, auto& part) { visit("hand.left.", name, part); });
    HandState::components(self.hand[1], [&](const char* name, auto& part) { visit("hand.right.", name, part); });
    visit("", "instruments", self.instruments);
    visit("", "tissue", self.tissue);
    visit("", "response", self.response);
    visit("", "retraction", self.retraction);
  }

  /// How many of them there are: the components of tissue come after.
  [[nodiscard]] std::size_t tissueFrom() const {
    std::size_t count = 0;
    ownComponents(*this, [&](const char*, const char*, const auto&) { ++count; });
    return count;
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
