// SPDX-License-Identifier: GPL-3.0-or-later
// Organs and fat that hold together, solved as one linear system, with their vessels. Internal to this folder.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "sim/solid/solid.h"
#include "sim/step/coupling.h"

namespace calot {

/// Groups of organs and fat that couplings join. Conjugate gradients run over all solids of a group at once,
/// preconditioned by each one's own sweeps.
class JoinedSolids {
 public:
  /// @param organs, vessels, fat of the model, in its order @param grown per organ: ties of vessels that are grown to
  /// it, tree by tree @param settings, responses of the solves for motion and for impulses
  JoinedSolids(const Model& model, std::vector<OrganBody*> organs, const std::vector<VesselBody*>& vessels,
               const std::vector<FatMotion*>& fat, const std::vector<std::vector<std::size_t>>& grown,
               const SolidSolver::Settings& settings, const SolidSolver::Settings& responses);

  /// Linearises all couplings over the step, and groups organs and fat by those that hold.
  /// @param awake per body @pre solveUnconstrained() of the vessels that are awake
  void linearise(const State& state, const std::vector<bool>& awake);

  /// Bodies (organs and fat, by their numbers among all) that are solved together, ascending; groups by their first.
  /// A body that nothing holds is a group of its own. @pre linearise()
  [[nodiscard]] const std::vector<std::vector<std::size_t>>& groups() const { return group_; }
  [[nodiscard]] SolidBody& solid(std::size_t body) { return *solid_[numberOf(body)]; }
  /// Organs and bodies of fat.
  [[nodiscard]] std::size_t size() const { return solid_.size(); }
  [[nodiscard]] std::size_t bodyOf(std::size_t number) const { return number < organs_ ? number : number + vessels_; }
  /// Vessels solved together with the organ that they are grown to, by organs.
  [[nodiscard]] const std::vector<GrownVessels*>& grown() const { return grown_; }

  /// Appends the loads by which a body feels what holds it. @pre linearise()
  void addLoads(std::size_t body, std::vector<Attachment>& attachments, std::vector<JointAttachment>& joints) const;
  /// Solves the motion of a group, which pulls its vessels. @param loose applyImpulses() will follow, and solve what
  /// this leaves open @pre SolidBody::load() of each of its solids
  SolveReport solveUnconstrained(std::size_t group, bool loose);
  /// Adds the impulses on a body's nodes by which it feels what its vessels were pushed since (N s). @pre those of the
  /// bodies before it in its group
  void passOn(std::size_t body, std::vector<Vec3>& impulse);
  /// Solves the response to impulses and to what the last solve left open, likewise. @pre SolidSolver::takeImpulses()
  /// of each of its solids
  SolveReport applyImpulses(std::size_t group, bool loose);
  /// True if another solve has to follow.
  [[nodiscard]] bool isOpen(std::size_t group) const { return open_[group]; }
  [[nodiscard]] bool isAnyOpen() const { return std::find(open_.begin(), open_.end(), true) != open_.end(); }

 private:
  [[nodiscard]] std::size_t firstFat() const { return organs_ + vessels_; }
  /// Among organs and fat.
  [[nodiscard]] std::size_t numberOf(std::size_t body) const { return body < organs_ ? body : body - vessels_; }
  void join(std::size_t a, std::size_t b);
  [[nodiscard]] bool isOf(const Coupling& coupling, std::size_t group) const {
    return coupling.holds() && first_[numberOf(coupling.bodies()[1])] == group_[group][0];
  }
  SolveReport solve(std::size_t group, const SolidSolver::Settings& settings);

  std::size_t organs_, vessels_;
  std::vector<SolidBody*> solid_;  ///< organs, then fat
  SolidSolver::Settings settings_, responses_;
  std::vector<std::unique_ptr<Coupling>> coupling_;  ///< strands, of fat, grown vessels: the order of their parts
  std::vector<GrownVessels*> grown_;
  std::vector<std::size_t> first_;  ///< per solid: the first body of its group
  std::vector<std::vector<std::size_t>> group_;
  std::vector<bool> open_;  ///< per group: was the last solve a loose one?
  std::vector<SolidSolver*> solver_;
  std::vector<SolidSolver::Coupled> coupled_;
  std::vector<Coupling*> active_;
};

}  // namespace calot
