// SPDX-License-Identifier: GPL-3.0-or-later
// An organ in the step. Internal to this folder.
#pragma once

#include <vector>

#include "sim/solid/rest_compliance.h"
#include "sim/step/solid_body.h"

namespace calot {

class OrganBody final : public SolidBody {
 public:
  OrganBody(const Model& model, std::size_t organ, const SolidSolver::Settings& settings,
            const SolidSolver::Settings& responses, Executor& executor, const ComplianceShelf& shelf);

  [[nodiscard]] std::size_t nodes() const override { return solid_.nodes(); }
  [[nodiscard]] std::span<const Vec3> position(const State& state) const override;
  [[nodiscard]] std::span<const Vec3> velocity(const State& state) const override;
  [[nodiscard]] std::uint32_t& quietSteps(State& state) const override;
  void assembleUnconstrained(State& state, const Vec3& gravity, std::span<const Vec3> force,
                             std::span<const TieLoad> ties, const Surroundings& loads) override;
  void precomputeCompliance(std::span<const int> nodes) override { rest_.precomputeCompliance(nodes); }
  void precompute() override { solver_.precompute(solid_, settings_, executor_); }
  [[nodiscard]] Mat3 rotation(const State& state, int node) const override;
  [[nodiscard]] Mat3 block(int a, int b) const override { return rest_.block(a, b); }
  void blocks(std::span<const int> a, std::span<const int> b, std::span<double> out) const override {
    rest_.blocks(a, b, out);
  }
  bool advance(State& state) override;
  void stop(State& state) const override;

 private:
  std::size_t organ_;
  const SolidModel& solid_;
  SolidSolver::Settings settings_;
  Executor& executor_;
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

}  // namespace calot
