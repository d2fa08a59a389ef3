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
#include "sim/solid/compliance_store.h"
#include "sim/solid/point_coupling.h"
#include "sim/step/body.h"
#include "sim/step/solid_body.h"
#include "sim/step/step_log.h"
#include "sim/step/tie_coupling.h"
#include "sim/step/vessel_body.h"
#include "sim/step/vessel_reaction.h"

namespace calot {

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

  /// Appends the attachments by which an organ feels its strands. @pre linearise()
  void addAttachments(std::size_t organ, std::vector<Attachment>& out) const;

  /// Solves the motion of a group, which pulls the vessels that are tied to it. @param grown vessels on organs
  /// @param loose applyImpulses() will follow, and solve what this leaves open
  /// @pre SolidBody::assembleUnconstrained() of each of its solids
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
  [[nodiscard]] std::size_t bodyOf(std::size_t number) const {
    return number < organ_.size() ? number : number + vessel_.size();
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

/// Bodies that a step solves, and parts of State that it writes (the incremental digest hashes only those).
struct Activity {
  std::vector<bool> awake;    ///< per body: solved in this step
  std::vector<bool> written;  ///< per body: its State is not that of the step before
  std::vector<bool> frayed;   ///< per connective tissue: strands burned, touched, damaged or torn
  std::vector<bool> charred;  ///< per organ
  std::vector<bool> carved;   ///< per body of fat

  explicit Activity(const Model& model);
  void beginStep();
  /// Appends for each of State's components of tissue, in their order, whether the step wrote it.
  void appendWritten(const Bodies& bodies, std::vector<bool>& out) const;
  /// Wakes a body for the next step.
  void disturb(Bodies& bodies, State& state, std::size_t which) {
    bodies[which].quietSteps(state) = 0;
    written[which] = true;
  }
};

/// True while any strand of a connective tissue is attached.
bool holdsAnything(const ConnectiveState& tissue);

}  // namespace calot
