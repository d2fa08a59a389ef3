// SPDX-License-Identifier: GPL-3.0-or-later
// Vessels in the step. Internal to this folder.
#pragma once

#include <optional>
#include <vector>

#include "sim/step/body.h"
#include "sim/vessel/beam_solver.h"
#include "sim/vessel/tube_surface.h"

namespace calot {

class VesselBody final : public Body {
 public:
  VesselBody(const Model& model, std::size_t tree, double step);

  [[nodiscard]] std::size_t nodes() const override { return beams_.nodes(); }
  [[nodiscard]] std::span<const Vec3> position(const State& state) const override;
  [[nodiscard]] std::span<const Vec3> velocity(const State& state) const override;
  [[nodiscard]] std::uint32_t& quietSteps(State& state) const override;
  /// Free motion of a step under gravity, forces on the nodes (N; may be empty) and springs to other bodies.
  SolveReport solveUnconstrained(State& state, const Vec3& gravity, std::span<const Vec3> force,
                                 std::span<const TieLoad> ties);
  [[nodiscard]] std::span<const Vec3> freeVelocity() const override { return solver_.freeVelocity(); }
  /// Adds the answer to impulses on the nodes (N s). @pre solveUnconstrained() of this step
  void applyImpulses(std::span<const Vec3> impulse) { solver_.applyImpulses(beams_, impulse); }
  [[nodiscard]] const BeamModel& model() const { return beams_; }
  /// @pre solveUnconstrained() of this step
  [[nodiscard]] const BeamSolver& solver() const { return solver_; }
  void precomputeCompliance(std::span<const int> nodes) override { solver_.precomputeCompliance(beams_, nodes); }
  [[nodiscard]] Mat3 rotation(const State& state, int node) const override;
  [[nodiscard]] Mat3 block(int a, int b) const override { return solver_.block(a, b); }
  bool advance(State& state) override;
  [[nodiscard]] double heldBack() const override { return report_.limited ? report_.requestedSpeed : 0.0; }
  void stop(State& state) const override;

  /// Report of the last advance().
  [[nodiscard]] const BeamReport& report() const { return report_; }
  /// Per element, after advance(): pull (N) and stretch.
  [[nodiscard]] const std::vector<double>& tension() const { return solver_.tension(); }
  [[nodiscard]] const std::vector<double>& strain() const { return solver_.strain(); }

 private:
  std::size_t tree_;
  const BeamModel& beams_;
  double step_;
  BeamSolver solver_;
  BeamReport report_;
  std::vector<BeamAttachment> attachment_;
};

class TubeSkin final : public Skin {
 public:
  TubeSkin(const Model& model, std::size_t tree, std::size_t branch);

  bool follow(const State& state) override;
  [[nodiscard]] const ContactSurface& surface() const override { return *contact_; }
  void place(const State& state, std::vector<Vec3>& out) const override;
  [[nodiscard]] SolidSolver::Impulse influence(const std::array<int, 3>& corner, const Vec3& weight) const override;

 private:
  const BeamModel& beams_;
  std::size_t tree_;
  TubeSurface tube_;
  std::optional<ContactSurface> contact_;
};

}  // namespace calot
