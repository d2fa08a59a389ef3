// SPDX-License-Identifier: GPL-3.0-or-later
// An organ in the step. Internal to this folder.
#pragma once

#include <vector>

#include "sim/solid/rest_compliance.h"
#include "sim/step/body.h"

namespace calot {

class OrganBody final : public Body {
 public:
  OrganBody(const Model& model, std::size_t organ, const SolidSolver::Settings& settings,
            const SolidSolver::Settings& responses, Executor& executor);

  [[nodiscard]] std::size_t nodes() const override { return solid_.nodes(); }
  [[nodiscard]] std::span<const Vec3> position(const State& state) const override;
  [[nodiscard]] std::span<const Vec3> velocity(const State& state) const override;
  [[nodiscard]] std::uint32_t& quietSteps(State& state) const override;
  SolveReport solveUnconstrained(State& state, const Vec3& gravity, std::span<const Vec3> force,
                                 std::span<const TieLoad> ties, const Surroundings& loads) override;
  [[nodiscard]] std::span<const Vec3> freeVelocity() const override { return solver_.freeVelocity(); }
  SolveReport applyImpulses(std::span<const Vec3> impulse) override;
  /// Assembles the step's system, which is then solved by solver() alone or joined with others.
  void assembleUnconstrained(State& state, const Vec3& gravity, std::span<const Vec3> force,
                             std::span<const TieLoad> ties, const Surroundings& loads);
  [[nodiscard]] SolidSolver& solver() { return solver_; }
  void precomputeCompliance(std::span<const int> nodes) override { rest_.precomputeCompliance(nodes); }
  void precompute() override { solver_.precompute(solid_, settings_, executor_); }
  [[nodiscard]] Mat3 rotation(const State& state, int node) const override;
  [[nodiscard]] Mat3 block(int a, int b) const override { return rest_.block(a, b); }
  void blocks(std::span<const int> a, std::span<const int> b, std::span<double> out) const override {
    rest_.blocks(a, b, out);
  }
  bool advance(State& state) override;
  [[nodiscard]] double heldBack() const override { return solver_.heldBack(); }
  void stop(State& state) const override;

 private:
  std::size_t organ_;
  const SolidModel& solid_;
  SolidSolver::Settings settings_, responses_;
  Executor& executor_;
  SolidSolver solver_;
  RestCompliance rest_;
  std::vector<Attachment> load_;
};

class OrganSkin final : public Skin {
 public:
  OrganSkin(const Model& model, std::size_t organ) : organ_(organ), model_(model.organs()[organ]) {}

  bool follow(const State& state) override;
  [[nodiscard]] const ContactSurface& surface() const override { return model_.surface; }
  void place(const State& state, std::vector<Vec3>& out) const override;
  [[nodiscard]] SolidSolver::Impulse influence(const std::array<int, 3>& corner, const Vec3& weight) const override;

 private:
  std::size_t organ_;
  const OrganModel& model_;
};

/// Springs to other bodies as a solid takes them.
void addAttachments(std::span<const TieLoad> ties, double step, std::span<const Vec3> position,
                    std::vector<Attachment>& out);

}  // namespace calot
