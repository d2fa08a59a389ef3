// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that a step solves: organs, then vessel trees, then fat, each behind Body. Internal to this folder.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/connective/connective_tissue.h"
#include "sim/math/executor.h"
#include "sim/math/linear.h"
#include "sim/math/vectors.h"
#include "sim/scene/model.h"
#include "sim/solid/conjugate_gradient.h"
#include "sim/solid/solid.h"
#include "sim/step/body.h"
#include "sim/vessel/beam_solver.h"

namespace calot {

/// Vessels that are grown to an organ, solved together with it.
///
/// A tie of stiffness k and damping c between a place of the organ (velocity V) and a node of a vessel (velocity v)
/// pulls the vessel, implicit on both sides, with
///   F = k g + d (V - v),    g the gap now, h the step, d = h k + c.
/// With C the vessels' exact compliance at all tied nodes and v0 their velocity without ties, v = v0 + h C F, so
///   F = D (g k / d + V - v0),    D = (1 / d + h C)^-1:
/// vessels move first, the organ then feels them as springs and dampers D that respond to one another
/// (JointAttachment), and F is what the vessels are pushed with afterwards. That is the solution of the one linear
/// system of organ and vessels: a force is the same on both sides, and implicit Euler's damping holds for the whole,
/// however stiff the ties.
class TieCoupling {
 public:
  /// @param ties of Model::ties(), all between this organ and vessels, none of fat
  TieCoupling(const Model& model, std::size_t organ, std::vector<std::size_t> ties, double step);

  [[nodiscard]] std::size_t organ() const { return organ_; }
  [[nodiscard]] bool joins(std::size_t body) const;

  /// Gathers the vessels' contact-free velocities, and pulls them as if the organ went on as it did.
  /// @pre solveUnconstrained() of all vessels that it joins
  void begin(const State& state, std::span<const std::unique_ptr<Body>> body, std::span<VesselBody* const> vessels);
  /// Impulse on the organ. @pre begin()
  [[nodiscard]] const JointAttachment& joint() const { return joint_; }
  /// Pulls the vessels, with these velocities of the organ's nodes. @pre begin()
  void pull(std::span<const Vec3> organVelocity, std::span<VesselBody* const> vessels);
  [[nodiscard]] std::size_t size() const { return tie_.size(); }
  /// Node of the vessel's body at which a tie holds. @return -1: it holds another body
  [[nodiscard]] int nodeOf(std::size_t tie, std::size_t vessel) const {
    return vesselOf(tie) == vessel ? nodeOf(tie) : -1;
  }
  /// Product of the matrix of organ, vessels and further couplings with the present search direction: the impulses of
  /// the organ's ties on a vessel, and their reaction on the organ. @param vessel its body's number @param response the
  /// vessel's response to other impulses, without the ties, at the node of each tie @param push per tie @pre begin()
  void react(const SolidSystem& organ, ConjugateGradient& gradient, std::size_t vessel, std::span<const Vec3> response,
             std::vector<Vec3>& push);

  /// Impulses on the organ's nodes by which it feels what vessels were pushed since; holds these, with these velocities
  /// of the organ's nodes. Then the organ has to be pushed, and pull() called.
  void passOn(std::span<const Vec3> organVelocity, std::span<VesselBody* const> vessels, std::vector<Vec3>& impulse);

  /// Compliance used by the contact solver: (1 / d + h (C of vessels + C of the organ))^-1, on the organ's compliance
  /// of contact.
  /// @pre begin()
  void stiffen(const State& state, std::span<const std::unique_ptr<Body>> body);
  /// Relative velocities of all ties (organ minus vessel) for a unit impulse at a place of a body, weighted and rotated
  /// as Body::block() is to be. @pre stiffen()
  void responses(const Body& body, std::size_t which, const SolidSolver::Impulse& place, std::span<const Mat3> rotation,
                 std::vector<Mat3>& out) const;
  /// Impulses of the ties on the organ that responses() cause.
  void tieImpulses(std::span<const Mat3> responses, std::vector<Mat3>& out) const;
  /// Reduction, by the ties, of the velocity at one place for an impulse at another.
  /// @param responses at the one place @param tieImpulses for the other
  [[nodiscard]] Mat3 schurComplement(std::span<const Mat3> responses, std::span<const Mat3> tieImpulses) const;

  /// Forces on the vessels (N), by ties. @pre pull()
  [[nodiscard]] const std::vector<Vec3>& force() const { return force_; }

 private:
  [[nodiscard]] const Tie& tie(std::size_t i) const { return model_.ties()[tie_[i]]; }
  [[nodiscard]] std::size_t vesselOf(std::size_t i) const { return tie(i).body[1]; }
  [[nodiscard]] int nodeOf(std::size_t i) const { return tie(i).place[1].node[0]; }
  [[nodiscard]] Vec3 applied(std::size_t i, std::span<const Vec3> velocity) const;
  [[nodiscard]] const Vec3& velocityOf(std::size_t i, std::span<VesselBody* const> vessels) const;
  void gatherImpulses(std::span<VesselBody* const> vessels);
  void rigidity(std::span<const std::unique_ptr<Body>> body, std::vector<double>& out) const;

  const Model& model_;
  std::size_t organ_, organNodes_;
  std::vector<std::size_t> tie_;
  double step_;
  std::vector<int> organNode_;  ///< distinct nodes of the organ at the ties, ascending
  std::vector<double> inverse_, tight_;
  std::vector<Mat3> rotation_;  ///< of organNode_
  JointAttachment joint_;
  std::vector<Vec3> ahead_;       ///< g k / d (m/s)
  std::vector<Vec3> vesselSeen_;  ///< velocities that the organ knows of
  std::vector<Vec3> force_, change_, more_;
  std::vector<Vec3> impulse_;
};

/// The ties between a body of fat and a tree of vessels. With A_v the vessels' matrix (exactly factorised, with the
/// ties' dampers d = h k + c on its diagonal), N the nodes of the ties and P their places in the fat, what vessels
/// answer to fat is
///   -(h d P)^T N A_v^-1 N^T (h d P)
/// in the fat's matrix: the system of both, solved by elimination (a Schur complement). Each product with it costs one
/// pass over the vessels (TreeResponse). Vessels that are grown to an organ couple it to the fat besides
/// (TieCoupling::react()).
class VesselReaction final : public SystemCoupling {
 public:
  VesselReaction(const Model& model, std::size_t fat, std::size_t tree);

  [[nodiscard]] std::size_t fat() const { return fat_; }
  [[nodiscard]] std::size_t tree() const { return tree_; }
  /// True if there is any such tie.
  [[nodiscard]] bool exists() const { return !tie_.empty(); }
  /// True while any of them holds. @pre linearise() of this step
  [[nodiscard]] bool holds() const { return holds_; }

  /// Takes the ties as they are left. @param awake otherwise nothing of it holds
  void linearise(const State& state, bool awake, const FatMotion& fat, double step);
  /// @param grown how the vessels are grown to an organ, or null @param organ its system of this step
  /// @pre linearise(); the fat's system of this step is assembled, the vessels are solved
  void assemble(FatMotion& fat, VesselBody& vessel, TieCoupling* grown, const SolidSystem* organ);
  /// @param organ to which the vessels are grown; if to none, the fat again
  void addTo(ConjugateGradient& organ, ConjugateGradient& fat) override;

  /// Lets the vessels follow the fat. @pre the fat was solved
  void pull(const FatMotion& fat, VesselBody& vessel);
  /// The fat knows how the vessels move now.
  void see(const VesselBody& vessel);
  /// Adds the impulses on the fat's nodes by which it feels what vessels were pushed since. @pre see()
  void passOn(const FatMotion& fat, const VesselBody& vessel, std::vector<Vec3>& impulse);

 private:
  /// By how much a row of the fat's system takes part in the force on a node: h d w of one tie (kg).
  struct Share {
    std::size_t row;
    std::uint32_t node;
    double weight;
  };

  [[nodiscard]] std::size_t nodeOf(std::size_t i) const;
  [[nodiscard]] const MaterialPoint& placeOf(std::size_t i) const;
  void sumShares(const SolidSystem& fat, const TieCoupling* grown);
  void findReach(const VesselBody& vessel);
  void addGrown(ConjugateGradient& organ);

  const Model& model_;
  std::size_t fat_, tree_;
  std::vector<std::size_t> tie_;  ///< of the model
  bool holds_ = false;
  std::vector<double> weight_;    ///< h d (kg)
  std::vector<Vec3> fatSeen_;     ///< velocity at the tie that the vessels know of (m/s)
  std::vector<Vec3> vesselSeen_;  ///< per node: its velocity that the fat knows of (m/s)
  // h d P, summed over ties: by rows of the fat's system, then nodes.
  std::vector<std::size_t> row_, start_;  ///< rows; where their shares begin, and the end
  std::vector<std::uint32_t> node_;       ///< per share: number in `touched_`
  std::vector<float> shareOf_;            ///< per share (kg)
  std::vector<std::uint32_t> touched_;    ///< nodes with any share, and those grown to an organ, ascending
  std::vector<double> summed_;            ///< weights of which those are the sums
  std::uint64_t version_ = 0;             ///< of the fat's system for which they are
  TieCoupling* grown_ = nullptr;          ///< how they are grown to an organ, or null
  const SolidSystem* organ_ = nullptr;    ///< of that
  TreeResponse response_;
  std::vector<FourFloats> moved_;  ///< pushes, then answers, of `touched_`
  // Per tie of `grown_`: its node's index in `touched_`, or none; then the columns of the response of `touched_`.
  std::vector<std::uint32_t> held_;
  std::vector<FourFloats> reach_;
  std::vector<Vec3> heldResponse_, heldPush_;
  std::vector<Vec3> push_;  ///< of pull(), per node
};

// Organs and fat that are tied to one another, solved as one linear system, with the vessels in the fat. Internal to
// this folder.
//
// Strands and ties add to each solid's own matrix on the diagonal (Attachment) and couple the solids beside it
// (PointCoupling); vessels in fat are eliminated (VesselReaction). That is implicit Euler of the whole, with forces
// that are equal and opposite. Conjugate gradients run over all solids of a group at once, preconditioned by each one's
// own sweeps.

class JoinedSolids {
 public:
  /// @param organs, vessels, fat of the model, in its order @param settings, responses of the solves for motion and for
  /// impulses
  JoinedSolids(const Model& model, std::vector<OrganBody*> organs, std::vector<VesselBody*> vessels,
               std::vector<FatMotion*> fat, const SolidSolver::Settings& settings,
               const SolidSolver::Settings& responses);

  /// Groups organs and fat by what holds them together, and linearises strands and ties over the step. Those of
  /// sleeping bodies are left out. @param awake per body @pre solveUnconstrained() of the vessels that are awake
  /// @param grown vessels on organs
  void linearise(const State& state, const std::vector<bool>& awake, std::span<TieCoupling> grown);

  /// Bodies (organs and fat, by their numbers among all) that are solved together, ascending; groups by their first.
  /// A body without ties is a group of its own. @pre linearise()
  [[nodiscard]] const std::vector<std::vector<std::size_t>>& groups() const { return group_; }
  [[nodiscard]] SolidBody& solid(std::size_t body) { return *solid_[numberOf(body)]; }
  /// Organs and bodies of fat.
  [[nodiscard]] std::size_t size() const { return solid_.size(); }
  [[nodiscard]] std::size_t bodyOf(std::size_t number) const {
    return number < organ_.size() ? number : number + vessel_.size();
  }

  /// Appends the attachments by which an organ feels its strands. @pre linearise()
  void addAttachments(std::size_t organ, std::vector<Attachment>& out) const;

  /// Solves the motion of a group, which pulls the vessels that are tied to it. @param grown vessels on organs
  /// @param loose applyImpulses() will follow, and solve what this leaves open
  /// @pre SolidBody::load() of each of its solids
  SolveReport solveUnconstrained(std::size_t group, std::span<TieCoupling> grown, bool loose);
  /// Impulses on fat by which it feels what the vessels in it were pushed since. @pre TieCoupling::passOn() of the
  /// group
  void passOn(std::size_t body, std::vector<Vec3>& impulse);
  /// Solves the response to impulses and to what the last solve left open, likewise. @pre SolidSolver::takeImpulses()
  /// of each of its solids
  SolveReport applyImpulses(std::size_t group, std::span<TieCoupling> grown, bool loose);
  /// True if another solve has to follow.
  [[nodiscard]] bool isOpen(std::size_t group) const { return open_[group]; }
  [[nodiscard]] bool isAnyOpen() const { return std::find(open_.begin(), open_.end(), true) != open_.end(); }

 private:
  /// A connective tissue's part in the system of its group.
  struct Tissue {
    std::unique_ptr<PointCoupling> coupling;
    ConnectiveLoads loads;
    bool holds = false;  ///< is any strand attached?
  };
  /// The ties between an organ and a body of fat.
  struct FatTies {
    std::size_t organ = 0, fat = 0;
    std::vector<std::size_t> tie;  ///< of the model
    std::vector<std::array<MaterialPoint, 2>> place;
    std::vector<double> damper;  ///< h k + c, of what is left of each (N s/m)
    std::unique_ptr<PointCoupling> coupling;
    std::uint64_t version = 0;  ///< of the fat's system for which that is
    bool holds = false;
  };

  [[nodiscard]] std::size_t firstFat() const { return organ_.size() + vessel_.size(); }
  /// Among organs and fat.
  [[nodiscard]] std::size_t numberOf(std::size_t body) const {
    return body < organ_.size() ? body : body - vessel_.size();
  }
  void lineariseTissues(const State& state, const std::vector<bool>& awake);
  void lineariseFatTies(const State& state, const std::vector<bool>& awake, std::span<TieCoupling> grown);
  /// Tie of a tree of vessels to an organ, or null.
  [[nodiscard]] TieCoupling* grownOf(std::span<TieCoupling> grown, std::size_t tree) const;
  void join(std::size_t a, std::size_t b);
  /// True if a reaction acts in the group that begins with this body.
  [[nodiscard]] bool isOf(const VesselReaction& reaction, std::size_t first) const {
    return reaction.holds() && first_[organ_.size() + reaction.fat()] == first;
  }
  SolveReport solve(std::size_t group, std::span<TieCoupling> grown, const SolidSolver::Settings& settings);

  const Model& model_;
  std::vector<OrganBody*> organ_;
  std::vector<VesselBody*> vessel_;
  std::vector<FatMotion*> fat_;
  std::vector<SolidBody*> solid_;  ///< organs, then fat
  SolidSolver::Settings settings_, responses_;
  std::vector<Tissue> tissue_;
  std::vector<FatTies> fatTies_;
  std::vector<std::unique_ptr<VesselReaction>> reaction_;  ///< per fat and tree
  std::vector<std::size_t> first_;                         ///< per solid: the first body of its group
  std::vector<std::vector<std::size_t>> group_;
  std::vector<bool> open_;  ///< per group: was the last solve a loose one?
  std::vector<SolidSolver*> solver_;
  std::vector<SolidSolver::Coupled> coupled_;
};

/// The bodies of a scene with their linear solvers, and the couplings of vessels to the organs that they are grown to.
class Bodies {
 public:
  /// @param compliances that runs of the model share, or null
  Bodies(const Model& model, Executor& executor, ComplianceStore* compliances = nullptr);

  /// To be called when the State was replaced.
  void invalidate();
  /// Computes ahead what steps otherwise compute on first use. Changes no result.
  void precompute();
  /// Takes over replaced States; remembers where fat is for the strokes of this step.
  void beginStep(const State& state);

  [[nodiscard]] std::size_t size() const { return body_.size(); }
  [[nodiscard]] Body& operator[](std::size_t which) { return *body_[which]; }
  [[nodiscard]] const Body& operator[](std::size_t which) const { return *body_[which]; }
  [[nodiscard]] std::span<const std::unique_ptr<Body>> all() const { return body_; }

  [[nodiscard]] std::size_t organs() const { return model_.organs().size(); }
  [[nodiscard]] std::size_t firstFat() const { return organs() + vessel_.size(); }
  /// Organs and fat as they are tied to one another in this step.
  [[nodiscard]] JoinedSolids& joined() { return *joined_; }
  [[nodiscard]] const VesselBody& vessel(std::size_t tree) const { return *vessel_[tree]; }
  [[nodiscard]] std::span<VesselBody* const> vessels() const { return vessel_; }
  [[nodiscard]] FatMotion& fat(std::size_t index) { return *fat_[index]; }
  [[nodiscard]] const FatMotion& fat(std::size_t index) const { return *fat_[index]; }
  [[nodiscard]] std::size_t fatCount() const { return fat_.size(); }

  /// Ties that are springs on both sides: per body, the tie's number and which of its sides the body is.
  [[nodiscard]] const std::vector<std::pair<std::size_t, std::size_t>>& springsOf(std::size_t which) const {
    return springs_[which];
  }
  /// Vessels solved together with the organ that they are grown to.
  [[nodiscard]] std::vector<TieCoupling>& couplings() { return coupling_; }

  /// Share of a tie's stiffness that is left: ties of fat fade as the fat is carved.
  [[nodiscard]] double shareLeft(const Tie& tie) const;
  [[nodiscard]] std::size_t firstStructure(std::size_t which) const;
  [[nodiscard]] std::size_t structureOfVessel(std::size_t tree, std::size_t branch) const {
    return organs() + model_.vesselTrees()[tree].vessel[branch];
  }
  [[nodiscard]] std::size_t structureOfFat(std::size_t index) const {
    return model_.structures().size() - fat_.size() + index;
  }
  [[nodiscard]] double step() const { return settings_.step; }

 private:
  void sortTies();

  const Model& model_;
  SolidSolver::Settings settings_, responseSettings_;
  std::vector<std::unique_ptr<Body>> body_;
  std::vector<OrganBody*> organ_;
  std::unique_ptr<JoinedSolids> joined_;
  std::vector<VesselBody*> vessel_;
  std::vector<FatMotion*> fat_;
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> springs_;
  std::vector<TieCoupling> coupling_;
};

/// Bodies that a step solves and disturbs, and parts of State that it writes (the incremental digest hashes only
/// those).
struct Activity {
  std::vector<bool> awake;           ///< per body: solved in this step
  std::vector<std::uint32_t> quiet;  ///< per body: steps that it has been quiet, 0 where something wakes it
  std::vector<bool> written;         ///< per body: its State is not that of the step before
  std::vector<bool> reshaped;        ///< per body: stages after the motion changed its skin
  std::vector<bool> frayed;          ///< per connective tissue: strands burned, touched, damaged or torn
  std::vector<bool> charred;         ///< per organ
  std::vector<bool> carved;          ///< per body of fat

  explicit Activity(const Model& model);
  void beginStep();
  /// Appends for each of State's components of tissue, in their order, whether the step wrote it.
  void appendWritten(const Bodies& bodies, std::vector<bool>& out) const;
  /// Wakes a body for the next step. @pre wakeBodies() of this step, and nothing has settled yet
  void disturb(std::size_t body) {
    quiet[body] = 0;
    written[body] = true;
  }
  /// Its skin changed, besides.
  void reshape(std::size_t body) {
    disturb(body);
    reshaped[body] = true;
  }
};

/// True while any strand of a connective tissue is attached.
bool holdsAnything(const ConnectiveState& tissue);

}  // namespace calot
