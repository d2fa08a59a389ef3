// SPDX-License-Identifier: GPL-3.0-or-later
// What a step works with, and its parts in the order in which they run. Internal to this folder.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/contact/contact_solver.h"
#include "sim/contact/near_triangles.h"
#include "sim/contact/surface_surface.h"
#include "sim/instruments/instrument_shape.h"
#include "sim/instruments/port.h"
#include "sim/scene/body.h"
#include "sim/scene/fat_motion.h"
#include "sim/scene/stepper.h"
#include "sim/scene/tie_coupling.h"
#include "sim/scene/vessel_body.h"
#include "sim/solid/turned_blocks.h"

namespace calot {

namespace stepping {
inline constexpr double margin = 0.001;         ///< contacts nearer than this are watched even at rest (m)
inline constexpr double slack = 0.0005;         ///< rows whose free gap is larger take no part (m)
inline constexpr double largestSlide = 0.005;   ///< of a tip near a surface in one step (m)
inline constexpr double largestJawStep = 0.05;  ///< of a jaw near a surface in one step (rad)
inline constexpr double tissueSoftness = 1e-3;  ///< by which organs sink into each other for the force at a place (m/N)
inline constexpr std::size_t mostTissueContacts =
    96;                                            ///< between organs, the deepest; a coarse solid has no use for more
inline constexpr double largestRecovery = 0.0005;  ///< by which overlapping organs part in one step (m)
inline constexpr std::uint32_t quietSteps = 50;    ///< before an organ sleeps
inline constexpr double leastForce = 1e-6;         ///< N; below, nothing counts as touching
inline constexpr double heldDepth = 0.0035;        ///< that jaws may sink into what they hold (m)
inline constexpr double crushedDepth = 0.02;       ///< the same about a clip: deeper than any vessel is thick (m)
inline constexpr double broadCell = 0.02;          ///< m
inline constexpr double openJaw = 0.35;            ///< jaws opened wider act when they close (rad)
inline constexpr double cuttingJaw = 0.7;          ///< the same for scissors: blades that close further cut (rad)
inline constexpr double closedJaw = 0.25;          ///< jaws closed further hold, clip or cut what is between them (rad)
}  // namespace stepping

/// One block of the contact problem: an instrument on a structure, an organ on an organ, or held tissue.
struct ContactBlock {
  static constexpr std::size_t nobody = ~std::size_t{0};

  BlockKind kind = BlockKind::frictional;
  double limit = 0.0;           ///< friction coefficient; force of a hold (N)
  std::size_t hand = nobody;    ///< whose instrument is pushed along +direction,
  std::size_t other = nobody;   ///< or which body is,
  std::size_t body = 0;         ///< and which body along -direction
  std::size_t structure = 0;    ///< whose skin that is
  std::size_t anchor = nobody;  ///< of a hold: index of the held place
  std::array<Vec3, 3> direction{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  SolidSolver::Impulse place, otherPlace;  ///< where the bodies are pushed
  std::array<ToolRow, 3> tool{ToolRow::Zero(), ToolRow::Zero(), ToolRow::Zero()};
  std::array<double, 3> gap{};  ///< now; slip counts from the step's beginning (m)
  std::uint64_t key = 0;        ///< names the place: equal in two steps means the same one
  std::size_t row = 0;          ///< its first row

  [[nodiscard]] std::size_t rows() const { return blockRows(kind); }
};

/// Direction from the port to a tip, unit.
Vec3 axisOf(const Vec3& port, const Vec3& tip);

struct Stepper::Workspace {
  /// A place where an instrument stands inside an organ.
  struct Inside {
    ToolRow row;
    Vec3 normal;
    double gap;
  };
  /// Where a withdrawal led.
  struct Withdrawal {
    Pose pose;
    double depth;  ///< that is left (m)
    bool pinched;  ///< between tissue on two sides
  };

  Workspace(const Model& model_, Executor& executor_, MakeBroadPhase make);
  void invalidate();

  void readSamples(State& state, std::span<const TickSamples> samples);

  // contact_detection.cpp
  void refreshBounds(const State& state);
  /// Patches with all that a structure has no farther than `far` from a segment, or more. @pre refreshBounds()
  std::span<const std::uint32_t> patchesNear(std::size_t structure, const Vec3& p0, const Vec3& p1, double far);
  /// Capsules of a hand's instrument at a pose, in W, into `local` and `shape`.
  void shapeAt(const State& state, std::size_t hand, const Pose& pose, double jaw);
  /// How deep this part of the instrument may stand in a structure (m): jaws in what they hold, for a mesh does not
  /// fold between them, and in a vessel that they close a clip on, for a tube does not flatten between them; nothing
  /// else.
  [[nodiscard]] double allowance(const State& state, const HandState& hand, const Capsule& capsule,
                                 std::size_t structure) const;
  [[nodiscard]] bool isClosedOnClip(const State& state, const HandState& hand, std::size_t structure) const;
  double gapOf(const State& state, const HandState& hand, double reach);
  void advanceFreely(State& state, std::size_t hand);
  void detectInstruments(const State& state);
  void detectTissue(const State& state);
  [[nodiscard]] bool isInsideOut(const State& state, std::size_t organ, int vertex) const;
  void keepDeepest(std::size_t first);
  /// Rest tables of a tissue pair; those of an organ with itself are worked out when first asked for.
  const SurfacePair& restOf(std::size_t pair);
  void allow(double allowed, double far, std::size_t from);
  void addInstrumentBlock(const State& state, std::size_t hand, std::size_t structure, const SurfaceContact& contact);

  // grasping.cpp
  void dropLostPlaces(State& state, std::size_t hand);
  void openJaws(State& state, std::size_t hand);
  void closeJaws(State& state, std::size_t hand);
  void addHolds(const State& state);
  void letGo(State& state, std::size_t hand, EventKind why, double value);
  void finishHolds(State& state);

  // body_motion.cpp
  void wake(State& state);
  void moveFreely(State& state);
  void moveFreely(State& state, std::size_t which);
  void coupleTies(double step);
  void gatherTies(const State& state, std::size_t which);
  void disturb(State& state, std::size_t which);
  void countQuiet(State& state, std::size_t which, double speed);
  [[nodiscard]] std::size_t structureOf(std::size_t tree, std::size_t branch) const {
    return model.organs().size() + model.vesselTrees()[tree].vessel[branch];
  }
  [[nodiscard]] std::size_t firstStructure(std::size_t which) const;
  [[nodiscard]] std::size_t firstFat() const { return model.organs().size() + model.vesselTrees().size(); }
  void finishOrgans(State& state);
  void finishVessels(State& state);
  void tellTear(State& state, std::size_t tree, std::size_t torn);
  void finishFat(State& state);
  void gatherRetractions(const State& state, std::size_t organ);
  [[nodiscard]] double shareLeft(const Tie& tie) const;
  [[nodiscard]] Vec3 endOf(const State& state, const Tie& tie, std::size_t side) const;

  // connective_step.cpp
  void wakeJoined(const State& state);
  void gatherAttachments(const State& state, std::size_t organ);
  void finishConnective(State& state);

  // vessel_tools.cpp
  /// Where a vessel runs between jaws.
  struct Crossing {
    std::size_t structure = ContactBlock::nobody;
    BeamPlace place;
    double depth = 0.0;  ///< of its centre line from the jaws' crotch (m)
    double sine = 1.0;   ///< of the angle between vessel and jaws
    Pose frame;          ///< centre line there
    Stump stump = Stump::none;
  };
  [[nodiscard]] Crossing vesselBetween(const State& state, std::size_t hand, double length) const;
  bool isGripped(const State& state, std::size_t hand, const Crossing& crossing);
  void closeOnVessels(State& state, std::size_t hand);
  void setClipOn(State& state, std::size_t hand, const Crossing& crossing);
  void cutVessel(State& state, std::size_t hand, const Crossing& crossing);
  void partVessel(State& state, std::size_t structure, const BeamPlace& where, Parting how, EventKind kind,
                  std::size_t hand);

  // cautery.cpp
  void sweepHook(const State& state, std::size_t hand);
  void burn(State& state);
  bool carve(State& state, std::size_t hand, std::size_t fat);
  void burnSkin(State& state, std::size_t hand, std::size_t structure, const SurfaceContact& contact, double share);
  void perforate(State& state, std::size_t organ, const Vec3& where, double exposure);
  void tellSmoke(State& state, std::size_t hand, std::uint32_t source, double energy);

  // procedure_step.cpp
  [[nodiscard]] double leftIn(std::size_t region) const;
  [[nodiscard]] double lowerThirdAttached(const State& state) const;
  [[nodiscard]] bool isParted(const State& state, std::size_t structure) const;
  void judgeView(const State& state, ProcedureState& out) const;
  void finishProcedure(State& state);

  // contact_problem.cpp
  void recallForces(const State& state);
  void poseProblem(const State& state);
  void assembleCompliance(const State& state);
  void addCompliances();
  void measureGaps();
  void followChange();
  void solveContacts();
  void keepForces(State& state);

  // contact_response.cpp
  void addForces(std::size_t which, std::span<const double> forces, double scale, std::vector<Vec3>& nodal) const;
  void carryOut(std::span<const double> change);
  void move(State& state);
  double findInside(const State& state, const HandState& hand, const Vec3& port, const Pose& pose);
  ToolRow wayOut();
  Withdrawal withdrawFrom(const State& state, std::size_t hand, Pose pose);
  void withdraw(State& state, std::size_t hand);
  void publish(const State& state);

  void finishHands(State& state);
  void watchSpeeds(const State& state);
  void emit(EventKind kind, std::size_t hand, std::uint16_t subject, const Vec3& position, double value);
  [[nodiscard]] Pose simulated(const State& state, std::size_t hand) const {
    return {state.hand[hand].simulatedPosition, state.hand[hand].simulatedOrientation};
  }

  const Model& model;
  Executor& executor;
  SolidSolver::Settings settings;
  SolidSolver::Settings responseSettings;
  std::vector<std::unique_ptr<Body>> body;  // organs, then vessel trees
  std::vector<FatMotion*> fatMotion;
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> tiesOf;  // per body: ties, and which of their sides
  std::vector<TieCoupling> coupling;                                     // per organ that vessels are grown to
  std::vector<bool> solved;                                              // per body: moved freely already in this step
  std::vector<VesselBody*> vesselBody;                                   // per tree
  std::vector<std::unique_ptr<Skin>> skinOf;                             // per structure
  std::vector<std::unique_ptr<const SurfacePair>> selfRest;              // per organ; empty until it folds
  std::vector<NearTriangles> nearTriangles;                              // per tissue pair
  std::vector<std::unique_ptr<BroadPhase>> broad;
  std::vector<bool> bounded;               // per structure: broad phase holds bounds of the current positions
  std::vector<bool> moved;                 // per body: solved in this step
  std::vector<bool> stopped;               // per body: advance() met numbers that are not finite
  std::vector<bool> written;               // per body: its State is not that of the step before
  std::vector<Attachment> attachments;     // of the organ at hand
  std::vector<JointAttachment> joints;     // the same
  std::vector<TieLoad> tieLoads;           // of the body at hand
  std::vector<bool> frayed;                // per connective tissue: changed in this step
  std::vector<bool> charred;               // per organ: charred in this step
  std::vector<double> wholeRegion;         // of the procedure's fat: volumes of its regions before anything is carved
  std::vector<bool> carved;                // per body of fat: carved in this step
  std::vector<SweptCapsule> blades;        // of the hook, as fat feels them
  std::array<Pose, handCount> poseBefore;  // of the simulated instruments, at the step's beginning
  std::vector<std::uint32_t> strands;
  std::vector<HookSweep> sweeps;
  std::array<std::uint32_t, handCount> burnedTissue{};  // connective tissue that the hook burns in this step
  std::vector<std::vector<Vec3>> skin;                  // per structure: surface points of the current positions
  std::vector<std::vector<Box>> bounds;                 // per structure and patch
  std::vector<bool> refittable;                         // per structure: the broad phase knows earlier bounds
  std::vector<Box> earlierBounds;
  std::vector<BroadPhase::Pair> pairs;
  std::vector<std::uint32_t> patches;
  std::vector<SurfaceDisplacement> displacement;  // per organ
  std::vector<SurfaceContact> found;
  std::vector<Inside> inside;
  std::vector<VertexContact> foundVertices;
  std::vector<double> tissueGap;  // of the blocks between organs, as found (m)
  InstrumentShape local;          // of the instrument at hand, in I
  std::vector<Capsule> shape;     // the same in W
  std::vector<Box> queries;
  std::array<ToolRow, handCount> stretch{ToolRow::Zero(), ToolRow::Zero()};  // of the virtual coupling
  std::array<double, handCount> reach{};                                     // how far contacts were looked for (m)
  std::vector<ContactBlock> blocks;
  std::size_t rows = 0;
  ContactSolver contactSolver;
  std::vector<BlockKind> kinds;
  std::vector<double> limits;
  std::vector<TurnColumns> turns;                     // of assembleCompliance()
  std::vector<double> nodeBlocks;                     // the same
  std::vector<double> tissueCompliance;               // what carryOut() is expected to do to the gaps
  std::vector<double> couplingCompliance;             // of the virtual couplings
  std::vector<double> compliance;                     // of both
  std::vector<double> gapBefore, expected, answered;  // of followChange()
  std::vector<double> lambda, carried;                // forces: decided, and those that organs move under already
  std::vector<double> trueGap;                        // with the forces carried out
  std::vector<double> freeGap, gap, change;
  std::vector<std::vector<Vec3>> nodal;  // per body
  std::array<ContactSet, handCount> contactSet;
  IncrementalDigest digest;
  StepResult result;
};

}  // namespace calot
