// SPDX-License-Identifier: GPL-3.0-or-later
// The stages of a step, each with what it reads and writes (stage 8: tissue_effects.h). Internal to this folder.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/contact/contact_solver.h"
#include "sim/haptics/haptic_tick.h"
#include "sim/scene/model.h"
#include "sim/scene/samples.h"
#include "sim/scene/state.h"
#include "sim/solid/block_matrix.h"
#include "sim/step/bodies.h"
#include "sim/step/body.h"
#include "sim/step/contact_block.h"
#include "sim/step/placed_instrument.h"
#include "sim/step/specimen_hold.h"
#include "sim/step/surfaces.h"
#include "sim/step/tissue_contacts.h"
#include "sim/tissue/organ/organ_tissue.h"

namespace calot {

// Stage 1 of a step: the newest measurement of each hand, and the newest camera.

/// Reads: the step's samples. Writes: each hand's input and mounted instrument, what is asked of the assistant, the
/// camera, and the digests of the samples as they came. A sample that is no measurement (isMeasurement) changes nothing
/// else but is reported when it begins and when it ends.
class SampleStage {
 public:
  explicit SampleStage(const Model& model) : model_(model) {}
  /// @pre samples.size() == ticksPerStep
  void run(std::span<const TickSamples> samples, State& state, StepLog& log) const;

 private:
  void readHand(std::span<const TickSamples> samples, std::size_t hand, State& state, StepLog& log) const;
  void readRequests(std::span<const TickSamples> samples, std::size_t hand, State& state, StepLog& log) const;
  void askAssistant(std::size_t hand, bool more, State& state, StepLog& log) const;
  const Model& model_;
};

// Stage 2 of a step: instruments follow the hands as far as free space reaches.

/// Contacts nearer than this are watched even at rest (m). Larger: more rows of contact that stay open; smaller: a tip
/// that tissue moves towards is found late. Assumed: the way of tissue at 0.1 m/s in one step.
inline constexpr double contactMargin = 0.001;
/// Travel of a tip near a surface in one step (m). Larger: contact is linearised over more than the surface's curvature
/// allows; smaller: fast hands leave their instrument behind. Assumed: half an instrument's working end.
inline constexpr double maxSlide = 0.005;

/// Conservative advancement (Mirtich 1996): the simulated instrument goes towards the real one as far as free space
/// reaches, so that nothing is passed through on the way. What is left is the stretch of the virtual coupling; the jaws
/// go on by a little whether there is room or not, since a hand closes them. The other instrument bounds free space as
/// tissue does: the left one moves first, and each stops before where the other is at that time.
///
/// Reads: real poses, surfaces. Writes: simulated poses, jaws and grasps of the hands (jaws that open release before,
/// jaws that close grasp after the motion).
class InstrumentMotion {
 public:
  /// @param grasping outlives this
  InstrumentMotion(const Model& model, Grasping& grasping) : model_(model), grasping_(grasping) {}
  /// @pre surfaces are current
  InstrumentTravels run(const Surfaces& surfaces, State& state, StepLog& log, ContactResult& contact);

 private:
  void advance(const Surfaces& surfaces, std::size_t hand, State& state, InstrumentTravel& travel);
  double gapOf(const Surfaces& surfaces, const State& state, std::size_t hand, double limit);

  const Model& model_;
  Grasping& grasping_;
  PlacedInstrument instrument_, other_;
  Surfaces::Search search_;
};

// Stage 3 of a step: contact points of instruments and among organs, and the bodies that are awake.

/// Reads: simulated instruments, surfaces, velocities of the tissue. Writes: `contact.blocks` (in the order of hand,
/// structure and contact point; grasps; instruments on each other; tissue on tissue), and which bodies are awake.
/// Contact among tissue is searched while awake solids are linearised (SolidBody::linearise()): neither needs the
/// other.
class ContactDetection {
 public:
  /// @param grasping, executor outlive this
  ContactDetection(const Model& model, const Grasping& grasping, Executor& executor)
      : model_(model),
        grasping_(grasping),
        executor_(executor),
        tissue_(model),
        travel_(model),
        vessels_(model, travel_),
        fat_(model, travel_) {}

  void invalidate() {
    tissue_.invalidate();
    travel_.invalidate();
    vessels_.invalidate();
    fat_.invalidate();
  }
  void precompute() { tissue_.precompute(); }
  /// @return the overlap of tissue as found (m) @pre surfaces are current
  double run(const Surfaces& surfaces, Bodies& bodies, const InstrumentTravels& travels, const State& state,
             Activity& activity, ContactSystem& contact);

 private:
  double findTissueContacts(const Surfaces& surfaces, const Bodies& bodies, const State& state,
                            const Activity& activity, std::vector<ContactBlock>& blocks);
  void findInstrumentContacts(const Surfaces& surfaces, const Bodies& bodies, const InstrumentTravels& travels,
                              const State& state, std::vector<ContactBlock>& blocks);
  void addInstrumentBlock(const Surfaces& surfaces, const State& state, std::size_t hand, std::size_t structure,
                          const SurfaceContact& contact, std::vector<ContactBlock>& blocks) const;

  void findClashes(const InstrumentTravels& travels, std::vector<ContactBlock>& blocks);

  const Model& model_;
  const Grasping& grasping_;
  Executor& executor_;
  TissueContacts tissue_;
  TissueTravel travel_;
  VesselContacts vessels_;
  FatContacts fat_;
  /// A hand and a structure.
  struct Touching {
    Surfaces::Search search;
    std::vector<SurfaceContact> found;
  };
  std::array<PlacedInstrument, handCount> instrument_;
  std::vector<Touching> touching_;  ///< by hands, then structures
  std::vector<ClashPoint> clash_;
};

// The patch of a skin that takes the force of an instrument's capsule. Internal to this folder.
//
// A force on the corners of one triangle pulls a node down by more than its cell where cells are as small as the tip,
// and into a cone where they are larger: neither is linear any more. So a part of the force goes to a ring of points
// about the contact point. How the skin gives way under such a load follows from the nodes' weights (meshSpread()); the
// dimple is what a round end sinks in beyond that.

/// Nodes that take the force of a capsule on a triangle of a skin. Depends on the place alone, not on how the
/// skin is deformed. @param weight barycentric coordinates @param radius of the capsule (m)
SolidSolver::Impulse pressedPatch(const Skin& skin, const std::array<int, 3>& node, const Vec3& weight, double radius);

// Stage 4 of a step: the unconstrained motion of all tissue.

/// Reports a solve of a body that did not reach its tolerance.
void reportMiss(const Bodies& bodies, std::size_t which, const SolveReport& report, StepLog& log);

/// One implicit step of each awake body under gravity, ties, connective tissue and retraction, and under the contact
/// forces that the last step left: vessels first, then organs (those that connective tissue ties as one system), which
/// take the vessels that are grown to them along, then fat. A body solved later sees the new velocities of those before
/// it.
///
/// Reads: State, `contact.carried`. Writes: rotations of State, contact-free velocities (Body::freeVelocity()),
/// residuals and iterations of the result.
class UnconstrainedMotion {
 public:
  explicit UnconstrainedMotion(const Model& model) : model_(model), solved_(model.bodies(), false) {}
  void run(Bodies& bodies, const ContactSystem& contact, const Activity& activity, State& state, StepResult& result,
           StepLog& log);

 private:
  void solveVessels(Bodies& bodies, const ContactSystem& contact, const Activity& activity, std::size_t tree,
                    State& state, StepLog& log);
  void solveGroup(Bodies& bodies, const ContactSystem& contact, const Activity& activity, std::size_t group,
                  State& state, StepResult& result, StepLog& log);
  void gatherLoads(Bodies& bodies, const ContactSystem& contact, const Activity& activity, const State& state,
                   std::size_t which);
  void gatherTies(const Bodies& bodies, const Activity& activity, const State& state, std::size_t which);
  void gatherRetractions(const Bodies& bodies, const State& state, std::size_t organ);
  [[nodiscard]] Vec3 endOf(const Bodies& bodies, const State& state, const Tie& tie, std::size_t side) const;

  const Model& model_;
  std::vector<bool> solved_;             ///< per body: in this step already
  std::vector<Vec3> nodal_;              ///< forces of contact on the body at hand (N)
  std::vector<Attachment> attachments_;  ///< of the body at hand
  std::vector<JointAttachment> joints_;
  std::vector<TieLoad> tieLoads_;
};

// Stage 5 of a step: gaps and compliance of the contact problem.
//
// Tissue moved under the forces of the last step. What has to change is decided on a cheap compliance (that of the
// reference configuration, rotated with the nodes), applied by the step's own matrix in one solve for all forces
// together, and decided again with the gaps that this left (stage 6). A force that stays as it is costs nothing and
// carries no error of the compliance: at rest the gaps are those of the true equilibrium.

/// Rows whose gap stays wider take no part (m). Larger: more rows; smaller: contacts that close within the step are
/// missed. Assumed: half of contactMargin.
inline constexpr double openGap = 0.0005;

/// By which organs sink into each other for the force at a contact point (m/N): a skin softer than the mesh can show.
/// Larger: visible overlap; smaller: rows that repeat each other. Assumed.
inline constexpr double tissueSoftness = 1e-3;

/// Gaps that the bodies' present velocities lead to, instruments at their real poses and pushed by `lambda`:
/// `contact.trueGap`.
void measureGaps(const Model& model, const Bodies& bodies, const Activity& activity, const InstrumentTravels& travels,
                 ContactSystem& contact);

/// W = estimate of the tissue + virtual couplings, with a small regularisation of its diagonal.
void sumCompliances(ContactSystem& contact);

/// Reads: contact-free velocities, rotations, travels. Writes: drops blocks that stay open; rows, gaps and compliances
/// of `contact`.
class ContactProblemStage {
 public:
  explicit ContactProblemStage(const Model& model) : model_(model) {}
  /// @return the largest violation of a row before any force changes (m)
  double run(Bodies& bodies, const Activity& activity, const InstrumentTravels& travels, const State& state,
             ContactSystem& contact);

 private:
  /// One body's part of a block: its nodes with weight and rotation, and the sign with which it opens the gap.
  struct Part {
    std::size_t block, body;
    double sign;
    const SolidSolver::Impulse* place;
    std::size_t rotations;                // of its nodes: weight times rotation
    std::optional<std::size_t> coupling;  // that the body takes part in
    std::vector<Mat3> responses;          // relative velocities of the coupling's ties
    std::vector<Mat3> impulses;           // with which the ties respond
    [[nodiscard]] std::span<const int> nodes() const { return {place->node.data(), place->count}; }
  };

  double dropOpenBlocks(ContactSystem& contact) const;
  std::vector<Part> partsOf(Bodies& bodies, const Activity& activity, const State& state, const ContactSystem& contact);
  void assembleTissue(Bodies& bodies, const std::vector<Part>& parts, ContactSystem& contact);
  void assembleCouplings(ContactSystem& contact) const;

  const Model& model_;
  std::vector<RotatedColumns> rotations_;
  std::vector<double> nodeBlocks_;
};

// What a contact problem knows from the steps before: forces, its warm start, and how tissue answered to them.

/// Numbers the rows and looks up the forces of the last step at the same contact points, projected onto what each block
/// admits: `carried` and `lambda`. The force of a point that an instrument left goes to where its capsule touches now.
/// Takes what was learned.
void loadWarmStart(const State& state, ContactSystem& contact);

/// Stores the forces by contact point, and what was learned, for the next step.
void storeWarmStart(const ContactSystem& contact, State& state);

/// Corrects the tissue's compliance W so that it gives the response y to a change s of the forces, and stays symmetric
/// and positive (BFGS; Nocedal and Wright 2006, 6.19):
///   W += y y^T / (y.s) - W s s^T W / (s.W s).
/// @param expected W s @pre y.s and s.W s are positive
void correctCompliance(std::span<const double> change, std::span<const double> response,
                       std::span<const double> expected, ContactSystem& contact);

/// Remembers a change of the forces and the tissue's response to it; the oldest are forgotten.
void learnResponse(std::span<const double> change, std::span<const double> response, ContactSystem& contact);

/// Corrects the tissue's compliance by what is remembered of the contact points that are still there, the oldest first.
/// Tissue turns and is cut: this is an estimate, and what it leaves is measured (stage 6).
void recallResponses(ContactSystem& contact);

// Stage 6 of a step: contact forces.

/// Solves the complementarity problem on the estimated compliance W, lets the tissue follow the change of forces by its
/// own matrix, corrects W by what that showed, and solves again with the gaps that are left, as often as the scene
/// allows.
///
/// Reads: the problem of stage 5. Writes: `contact.lambda` and `carried` (equal at the end), `freeGap`, velocities of
/// the bodies, solver figures of the result.
class ContactSolution {
 public:
  explicit ContactSolution(const Model& model) : model_(model) {}
  void run(Bodies& bodies, const Activity& activity, const InstrumentTravels& travels, ContactSystem& contact,
           ContactResult& result, StepLog& log);

 private:
  void solve(const ContactProblem& problem, ContactSystem& contact, ContactResult& result);
  void gatherImpulses(Bodies& bodies, const ContactSystem& contact, std::size_t which);
  void applyToGroup(Bodies& bodies, const Activity& activity, const ContactSystem& contact, std::size_t group,
                    StepLog& log);
  void applyContactImpulses(Bodies& bodies, const Activity& activity, const ContactSystem& contact, StepLog& log);
  std::array<double, 2> measureResponse(Bodies& bodies, const Activity& activity, const InstrumentTravels& travels,
                                        ContactSystem& contact);
  void updateComplianceEstimate(Bodies& bodies, const Activity& activity, const InstrumentTravels& travels,
                                ContactSystem& contact, StepLog& log);

  const Model& model_;
  ContactSolver solver_;
  bool loose_ = false;  ///< does another pass go on from the present one's solves?
  std::vector<double> gap_, change_;
  std::vector<double> gapBefore_, dimpleBefore_, forces_, expected_, response_;
  std::vector<Vec3> nodal_;
};

// Stage 7 of a step: bodies and instruments move, and the haptic loop gets its contact problem.

using ContactSets = std::array<ContactSet, handCount>;

/// Reads: velocities, contact forces, travels. Writes: positions and velocities of State, simulated poses, the warm
/// start, forces on the instruments, the contact sets for the ticks to come; surfaces are current afterwards.
class ContactResponse {
 public:
  explicit ContactResponse(const Model& model) : model_(model), resolver_(model), diverged_(model.bodies(), false) {}

  void run(Surfaces& surfaces, Bodies& bodies, const Activity& activity, const InstrumentTravels& travels,
           const ContactSystem& contact, State& state, ContactSets& sets, StepResult& result, StepLog& log);

  /// Per body: it met numbers that are not finite in this step.
  [[nodiscard]] const std::vector<bool>& diverged() const { return diverged_; }

 private:
  void integrateTissue(Surfaces& surfaces, Bodies& bodies, const Activity& activity, State& state, StepLog& log);
  void integrateInstrument(std::size_t hand, const InstrumentTravel& travel, const ContactSystem& contact, State& state,
                           HandResult& result) const;

  const Model& model_;
  PenetrationResolver resolver_;
  std::vector<bool> diverged_;
};

/// The step's problem reduced to one hand. The other hand's forces, and those among tissue, stay as they are. Where
/// the instruments touch, the other one yields by its coupling and goes on as it moved in this step.
/// @pre bodies and instruments have moved
void reduceToHand(const Bodies& bodies, const State& state, const InstrumentTravels& travels,
                  const ContactSystem& contact, std::size_t hand, std::uint64_t step, ContactSet& set);

// Stage 9 of a step: what follows from the whole of it.

/// Bodies come to rest, vessels tear, grasps slip or tear, touches begin and end; then it is known what fat still
/// holds. At last the guard of last resort: reports that the simulation ran away, and where.
///
/// Reads: contact forces, and what the stages before left. Writes: extents, sleep counters, partings, grasps and
/// touches of State; what they disturb; forces by structure, grasps, largest speeds and `holdsSpecimen` of the result.
class Settling {
 public:
  /// @param grasping outlives this
  Settling(const Model& model, Grasping& grasping) : model_(model), grasping_(grasping), hold_(model) {}
  void invalidate() { hold_.invalidate(); }
  /// @param diverged per body, see ContactResponse @pre surfaces are current but for what stage 8 changed
  void run(const ContactSystem& contact, const std::vector<bool>& diverged, Surfaces& surfaces, Bodies& bodies,
           State& state, Activity& activity, StepResult& result, StepLog& log);

 private:
  void settleOrgans(const ContactSystem& contact, Activity& activity, State& state, StepResult& result) const;
  void stopQuiet(std::size_t body, Bodies& bodies, const Activity& activity, State& state) const;
  void settleVessels(const ContactSystem& contact, Bodies& bodies, Activity& activity, State& state,
                     StepLog& log) const;
  void settleFat(const ContactSystem& contact, const Bodies& bodies, Activity& activity, State& state,
                 StepResult& result) const;
  void rest(Surfaces& surfaces, Bodies& bodies, const Activity& activity, State& state) const;
  void settleTouches(const ContactSystem& contact, std::size_t hand, State& state, HandResult& out, StepLog& log) const;
  void settleClash(const ContactSystem& contact, State& state, ContactResult& result, StepLog& log) const;
  void reportRunaway(const Bodies& bodies, const Activity& activity, const std::vector<bool>& diverged,
                     const State& state, StepLog& log) const;

  const Model& model_;
  Grasping& grasping_;
  SpecimenHold hold_;
};

// Stage 10 of a step: StepResult.

/// Copies what is left to be said of State and bodies. Decides nothing.
class Publication {
 public:
  /// @param bodies whose fat is uncarved yet
  Publication(const Model& model, const Bodies& bodies);
  void run(const Bodies& bodies, const Activity& activity, const State& state, StepResult& result) const;

 private:
  void publishOrgans(const State& state, StepResult& result) const;
  void publishConnective(const State& state, StepResult& result) const;
  void publishVessels(const Bodies& bodies, const Activity& activity, const State& state, StepResult& result) const;
  void publishVessel(const Bodies& bodies, bool awake, const State& state, std::size_t tree, std::size_t branch,
                     VesselResult& out) const;
  void publishFat(const Bodies& bodies, const Activity& activity, const State& state, StepResult& result) const;
  static void publishHand(const HandState& hand, const Vec3& port, HandResult& out);
  [[nodiscard]] double shareLeft(const Bodies& bodies, std::size_t fat, std::size_t region) const;

  const Model& model_;
  /// Per body of fat: volumes of its regions before anything is carved (m^3).
  std::vector<std::vector<double>> wholeRegion_;
};

// A body that nothing touches and nothing moves sleeps: no step solves it.

/// Wakes the bodies that an instrument is about to touch or grasps, those that another organ pressed in the last step,
/// those that an assistant pulls, and everything tied to them.
/// Reads: instrument blocks, travels, last forces, sleep counters. Writes: `awake`, `quiet` and `written` of
/// `activity`.
void wakeBodies(const Model& model, const Bodies& bodies, const InstrumentTravels& travels,
                std::span<const ContactBlock> blocks, const State& state, Activity& activity);

}  // namespace calot
