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
#include "sim/contact/surface_surface.h"
#include "sim/instruments/instrument_shape.h"
#include "sim/instruments/port.h"
#include "sim/scene/stepper.h"
#include "sim/solid/rest_compliance.h"

namespace calot {

namespace stepping {
inline constexpr double margin = 0.001;            ///< contacts nearer than this are watched even at rest (m)
inline constexpr double slack = 0.0005;            ///< rows whose free gap is larger take no part (m)
inline constexpr double largestSlide = 0.005;      ///< of a tip near a surface in one step (m)
inline constexpr double largestJawStep = 0.05;     ///< of a jaw near a surface in one step (rad)
inline constexpr double largestRecovery = 0.0005;  ///< by which overlapping organs part in one step (m)
inline constexpr std::uint32_t quietSteps = 50;    ///< before an organ sleeps
inline constexpr double leastForce = 1e-6;         ///< N; below, nothing counts as touching
inline constexpr double heldDepth = 0.0035;        ///< that jaws may sink into what they hold (m)
inline constexpr double broadCell = 0.02;          ///< m
}  // namespace stepping

/// One block of the contact problem: an instrument on an organ, an organ on an organ, or held tissue.
struct ContactBlock {
  static constexpr std::size_t nobody = ~std::size_t{0};

  BlockKind kind = BlockKind::frictional;
  double limit = 0.0;           ///< friction coefficient; force of a hold (N)
  std::size_t hand = nobody;    ///< whose instrument is pushed along +direction,
  std::size_t other = nobody;   ///< or which organ is,
  std::size_t organ = 0;        ///< and which organ along -direction
  std::size_t anchor = nobody;  ///< of a hold: index of the held place
  std::array<Vec3, 3> direction{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  SolidSolver::Impulse place, otherPlace;  ///< where the organs are pushed
  std::array<ToolRow, 3> tool{ToolRow::Zero(), ToolRow::Zero(), ToolRow::Zero()};
  std::array<double, 3> gap{};  ///< now; slip counts from the step's beginning (m)
  std::uint64_t key = 0;        ///< names the place: equal in two steps means the same one
  std::size_t row = 0;          ///< its first row

  [[nodiscard]] std::size_t rows() const { return blockRows(kind); }
};

/// A place on an organ's skin in terms of its solid's nodes: corner weights times anchor weights.
SolidSolver::Impulse influence(const std::array<int, 3>& corner, const Vec3& weight, const Embedding& embedding);

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
  std::span<const std::uint32_t> patchesNear(std::size_t organ, const Box& box);
  /// Capsules of a hand's instrument at a pose, in W, into `local` and `shape`.
  void shapeAt(const State& state, std::size_t hand, const Pose& pose, double jaw);
  /// How deep this part of the instrument may stand in an organ (m): jaws in what they hold, for a mesh does not fold
  /// between them; nothing else.
  [[nodiscard]] static double allowance(const HandState& hand, const Capsule& capsule, std::size_t organ);
  double gapOf(const HandState& hand, double reach);
  void advanceFreely(State& state, std::size_t hand);
  void detectInstruments(const State& state);
  void detectTissue(const State& state);
  /// Rest tables of a tissue pair; those of an organ with itself are worked out when first asked for.
  const SurfacePair& restOf(std::size_t pair);
  void allow(double allowed, double far, std::size_t from);
  void addInstrumentBlock(const State& state, std::size_t hand, std::size_t organ, const SurfaceContact& contact);

  // grasping.cpp
  void openJaws(State& state, std::size_t hand);
  void closeJaws(State& state, std::size_t hand);
  void addHolds(const State& state);
  void letGo(State& state, std::size_t hand, EventKind why, double value);
  void finishHolds(State& state);

  // organ_motion.cpp
  void wake(State& state);
  void moveFreely(State& state);
  void finishOrgans(State& state);

  // connective_step.cpp
  void wakeJoined(const State& state);
  void gatherAttachments(const State& state, std::size_t organ);
  void finishConnective(State& state);

  // contact_problem.cpp
  void recallForces(const State& state);
  void poseProblem(const State& state);
  void assembleCompliance(const State& state);
  void measureGaps();
  void solveContacts();
  void keepForces(State& state);

  // contact_response.cpp
  void addForces(std::size_t organ, std::span<const double> forces, double scale, std::vector<Vec3>& nodal) const;
  void carryOut(std::span<const double> change);
  void move(State& state);
  double findInside(const HandState& hand, const Vec3& port, const Pose& pose);
  ToolRow wayOut();
  Withdrawal withdrawFrom(const State& state, std::size_t hand, Pose pose);
  void withdraw(State& state, std::size_t hand);
  void publish(const State& state);

  void finishHands(State& state);
  void emit(EventKind kind, std::size_t hand, std::uint16_t subject, const Vec3& position, double value);
  [[nodiscard]] Pose simulated(const State& state, std::size_t hand) const {
    return {state.hand[hand].simulatedPosition, state.hand[hand].simulatedOrientation};
  }

  const Model& model;
  Executor& executor;
  SolidSolver::Settings settings;
  SolidSolver::Settings responseSettings;
  std::vector<SolidSolver> solver;  // per organ
  std::vector<std::unique_ptr<RestCompliance>> rest;
  std::vector<std::unique_ptr<const SurfacePair>> selfRest;  // per organ; empty until it folds
  std::vector<std::unique_ptr<BroadPhase>> broad;
  std::vector<bool> bounded;               // per organ: broad phase holds bounds of the current positions
  std::vector<bool> moved;                 // per organ: solved in this step
  std::vector<Attachment> attachments;     // of the organ at hand
  std::vector<bool> frayed;                // per connective tissue: changed in this step
  std::array<Pose, handCount> poseBefore;  // of the simulated instruments, at the step's beginning
  std::vector<std::uint32_t> strands;
  std::vector<HookSweep> sweeps;
  std::vector<std::vector<Vec3>> skin;   // per organ: surface points of the current positions
  std::vector<std::vector<Box>> bounds;  // per organ and patch
  std::vector<bool> refittable;          // per organ: the broad phase knows earlier bounds
  std::vector<Box> earlierBounds;
  std::vector<BroadPhase::Pair> pairs;
  std::vector<std::uint32_t> patches;
  std::vector<SurfaceContact> found;
  std::vector<Inside> inside;
  std::vector<VertexContact> foundVertices;
  InstrumentShape local;       // of the instrument at hand, in I
  std::vector<Capsule> shape;  // the same in W
  std::vector<Box> queries;
  std::array<ToolRow, handCount> stretch{ToolRow::Zero(), ToolRow::Zero()};  // of the virtual coupling
  std::array<double, handCount> reach{};                                     // how far contacts were looked for (m)
  std::vector<ContactBlock> blocks;
  std::size_t rows = 0;
  ContactSolver contactSolver;
  std::vector<BlockKind> kinds;
  std::vector<double> limits;
  std::vector<double> tissueCompliance;  // what carryOut() is expected to do to the gaps
  std::vector<double> compliance;        // with that of the virtual couplings
  std::vector<double> lambda, carried;   // forces: decided, and those that organs move under already
  std::vector<double> trueGap;           // with the forces carried out
  std::vector<double> freeGap, gap, change;
  std::vector<std::vector<Vec3>> nodal;  // per organ
  std::array<ContactSet, handCount> contactSet;
  IncrementalDigest digest;
  StepResult result;
};

}  // namespace calot
