// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that a step solves: organs, then vessel trees, then fat, each behind Body. Internal to this folder.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim/math/executor.h"
#include "sim/scene/model.h"
#include "sim/solid/solid.h"
#include "sim/step/body.h"
#include "sim/step/joined_solids.h"

namespace calot {

/// The bodies of a scene with their linear solvers, and what holds them together.
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
  std::vector<std::vector<std::size_t>> sortTies();

  const Model& model_;
  SolidSolver::Settings settings_, responseSettings_;
  std::vector<std::unique_ptr<Body>> body_;
  std::vector<OrganBody*> organ_;
  std::unique_ptr<JoinedSolids> joined_;
  std::vector<VesselBody*> vessel_;
  std::vector<FatMotion*> fat_;
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> springs_;
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
