// SPDX-License-Identifier: GPL-3.0-or-later
// Organs and fat that are tied to one another, solved as one linear system, with the vessels in the fat. Internal to
// this folder.
//
// Strands and ties add to each solid's own matrix on the diagonal (Attachment) and couple the solids beside it
// (PointCoupling); vessels in fat are eliminated (VesselReaction). That is implicit Euler of the whole, with forces
// that are equal and opposite. Conjugate gradients run over all solids of a group at once, preconditioned by each one's
// own sweeps.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/connective/connective_tissue.h"
#include "sim/solid/point_coupling.h"
#include "sim/step/fat_motion.h"
#include "sim/step/organ_body.h"
#include "sim/step/vessel_body.h"
#include "sim/step/vessel_reaction.h"

namespace calot {

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
  /// What nothing ties is a group of its own. @pre linearise()
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
  /// Has another solve to follow?
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
  /// How a tree of vessels is grown to an organ, or null.
  [[nodiscard]] TieCoupling* grownOf(std::span<TieCoupling> grown, std::size_t tree) const;
  void join(std::size_t a, std::size_t b);
  /// Does a reaction hold in the group that begins with this body?
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

}  // namespace calot
