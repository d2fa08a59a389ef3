// SPDX-License-Identifier: GPL-3.0-or-later
// A hand's instrument as capsules in W: against the other one (both are unions of capsules, so the distance is exact),
// and out of tissue that it still stands in. Internal to this folder.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/instruments/instrument_shape.h"
#include "sim/scene/model.h"
#include "sim/scene/state.h"
#include "sim/step/contact_block.h"
#include "sim/step/surfaces.h"

namespace calot {

/// p_WI, q_WI.
inline Pose simulatedPose(const InstrumentState& instrument) { return {instrument.position, instrument.orientation}; }

/// The instrument's capsules at a pose.
struct PlacedInstrument {
  InstrumentShape local;         ///< in I
  Pose pose;                     ///< p_WI, q_WI
  Vec3 port = Vec3::Zero();      ///< p_WP (m)
  std::vector<Capsule> capsule;  ///< in W

  void place(const HandDescription& hand, InstrumentKind kind, const Pose& at, double jaw);

  /// As State has it.
  void place(const HandDescription& hand, const InstrumentState& as) {
    place(hand, as.kind, simulatedPose(as), as.jaw);
  }
};

/// At which a hand's hook divides tissue now, of the cutting current's pace; 0 without current.
double currentPace(const CauteryDescription& cautery, const HandState& hand);

/// Depth to which this part of the instrument may enter a structure (m): jaws in what they grasp, because a mesh does
/// not fold between them, and in a vessel that they close a clip on, because a tube does not flatten between them; an
/// energised electrode in fat, as far as that recedes in a step; 0 otherwise.
double allowedDepth(const Model& model, const State& state, std::size_t hand, const Capsule& capsule,
                    std::size_t structure);

/// Coulomb coefficient of an instrument on the other. Larger: shafts that cross drag each other along; smaller: they
/// slide off. Assumed: wet polished steel.
inline constexpr double instrumentFriction = 0.1;

/// A point at which instruments a and b are near each other.
struct ClashPoint {
  Vec3 onA = Vec3::Zero();  ///< points of the axes of both capsules (m, W)
  Vec3 onB = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  ///< unit, from b towards a
  double gap = 0.0;            ///< distance of the surfaces, negative: overlap (m)
  std::uint64_t key = 0;       ///< pieces of a and b, with clashKey
};

/// Bits 56 to 63 of a clash's key; no piece of an instrument has this number.
inline constexpr std::uint64_t clashKey = std::uint64_t{0xFF} << 56U;

/// True if two instruments are surely farther apart than `reach`: one test of their axes.
bool surelyApart(const PlacedInstrument& a, const PlacedInstrument& b, double reach);

/// Least distance of two instruments' surfaces (m), negative where they overlap; at most `limit`. Points in a port,
/// where the tip hardly feels what pushes, do not count, here and below: shafts cross there in the abdominal wall.
double gapBetween(const PlacedInstrument& a, const PlacedInstrument& b, double limit);

/// The nearest points of two instruments, nearer than `reach`: the nearest pair of pieces first, then every pair that
/// is not beside one that is listed already; at most `maxClashPoints`.
void clashPoints(const PlacedInstrument& a, const PlacedInstrument& b, double reach, std::vector<ClashPoint>& out);
inline constexpr std::size_t maxClashPoints = 4;  ///< two rigid straight bodies need no more

/// Rows of the contact problem are linear, tissue is not: what an instrument still penetrates after the step, it leaves
/// by the shortest motion of its own. In a fold the nearest surface may lie deeper in: then it goes back along its
/// shaft, the way it came in, and looks again. Where tissue presses from two sides there may be no way out: that depth
/// is reported as pinched.
class PenetrationResolver {
 public:
  explicit PenetrationResolver(const Model& model) : model_(model) {}

  /// Writes the hand's simulated pose; raises `contact.maxDepth` or `pinchedDepth` to what is left (m).
  /// @pre surfaces are current
  void run(const Surfaces& surfaces, std::size_t hand, State& state, ContactResult& contact);

 private:
  /// A point at which an instrument stands inside a structure or the other instrument.
  struct Inside {
    ToolRow row;
    Vec3 normal;
    double gap;
  };
  /// Result of a search.
  struct Outcome {
    Pose pose;
    double depth;  ///< that is left (m)
    bool pinched;  ///< between tissue on two sides
  };

  double findInside(const Surfaces& surfaces, const State& state, std::size_t hand, const Pose& pose);
  [[nodiscard]] ToolRow minWayOut() const;
  Outcome search(const Surfaces& surfaces, const State& state, std::size_t hand, Pose pose);

  const Model& model_;
  PlacedInstrument instrument_, other_;
  std::vector<ClashPoint> clash_;
  std::vector<SurfaceContact> found_;
  Surfaces::Search search_;
  std::vector<Inside> inside_;
};

/// Contacts of a hand's instrument with a structure, nearer than `far` (m). Their gaps count from allowedDepth(), and
/// from the dimples that the capsules press. @pre surfaces are current
void instrumentContacts(const Model& model, const Surfaces& surfaces, const State& state, std::size_t hand,
                        const PlacedInstrument& instrument, std::size_t structure, double far, Surfaces::Search& search,
                        std::vector<SurfaceContact>& out);

/// Jaws that close on tissue grasp it: points of a structure's skin between them are tied to the instrument (bilateral
/// blocks of the contact problem). They slip where the pull exceeds what the grip holds, and tear out above another
/// force.
class Grasping {
 public:
  explicit Grasping(const Model& model) : model_(model), resolver_(model) {}

  /// Before the instruments move: discards grasped points whose fat was carved away, and releases what open jaws or
  /// exchanged instruments held. Writes GraspState. @pre surfaces are current
  void release(const Surfaces& surfaces, State& state, StepLog& log, ContactResult& contact);
  /// After they moved: jaws that were open and close now grasp the tissue between them. @pre surfaces are current
  void close(const Surfaces& surfaces, State& state, StepLog& log) const;
  /// A bilateral block for each grasped point, added to `blocks`. @pre surfaces are current
  void addBlocks(const Surfaces& surfaces, const State& state, std::vector<ContactBlock>& blocks) const;
  /// After the step: tissue that slipped or tore out. Fills each hand's `grasping` and `graspForce`; an organ that
  /// tears is opened. @pre surfaces are current
  void settle(const Surfaces& surfaces, State& state, Activity& activity, StepResult& result, StepLog& log);

 private:
  void removeStaleGrasps(const Surfaces& surfaces, std::size_t hand, State& state, StepLog& log,
                         ContactResult& contact);
  void end(const Surfaces& surfaces, std::size_t hand, EventKind why, double value, State& state, StepLog& log,
           ContactResult& contact);
  void closeOne(const Surfaces& surfaces, std::size_t hand, State& state, StepLog& log) const;
  /// Moves slipping points along; discards those that left the jaws. @return whether any slips
  bool slip(const Surfaces& surfaces, std::size_t hand, State& state) const;
  [[nodiscard]] double heldFor(const GraspState& grasp, const State& state) const {
    return static_cast<double>(state.clock.step - grasp.since) * model_.stepSeconds();
  }

  const Model& model_;
  PenetrationResolver resolver_;
};

}  // namespace calot
