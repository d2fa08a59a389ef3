// SPDX-License-Identifier: GPL-3.0-or-later
// A body that conjugate gradients solve, alone or joined with others: an organ, fat. Internal to this folder.
#pragma once

#include <span>
#include <vector>

#include "sim/fat/fat_body.h"
#include "sim/solid/rest_compliance.h"
#include "sim/step/body.h"

namespace calot {

class SolidBody : public Body {
 public:
  /// Assembles the free motion of a step under gravity, forces on the nodes (N; may be empty), springs to other bodies
  /// and loads that were linearised elsewhere, for solver().
  virtual void assembleUnconstrained(State& state, const Vec3& gravity, std::span<const Vec3> force,
                                     std::span<const TieLoad> ties, const Surroundings& loads) = 0;
  [[nodiscard]] SolidSolver& solver() { return solver_; }
  [[nodiscard]] std::span<const Vec3> freeVelocity() const override { return solver_.freeVelocity(); }
  [[nodiscard]] double heldBack() const override { return solver_.heldBack(); }

 protected:
  SolidSolver solver_;
};

/// Springs to other bodies as a solid takes them.
void addAttachments(std::span<const TieLoad> ties, double step, std::span<const Vec3> position,
                    std::vector<Attachment>& out);

// An organ in the step. Internal to this folder.

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

// Fat in the step. Internal to this folder.

class FatMotion final : public SolidBody {
 public:
  FatMotion(const Model& model, std::size_t fat, const SolidSolver::Settings& settings,
            const SolidSolver::Settings& responses, Executor& executor, const ComplianceShelf& shelf);

  /// To be called when the State was replaced.
  void invalidate() { stale_ = true; }
  /// Adopts a replaced State; stores the tissue's position for the strokes of this step.
  void beginStep(const State& state);
  FatStroke stroke(State& state, std::span<const SweptCapsule> tool, double rise);
  [[nodiscard]] const FatBody& fat() const { return fat_; }

  [[nodiscard]] std::size_t nodes() const override { return fat_.model().solid().nodes(); }
  [[nodiscard]] std::span<const Vec3> position(const State& state) const override;
  [[nodiscard]] std::span<const Vec3> velocity(const State& state) const override;
  [[nodiscard]] std::uint32_t& quietSteps(State& state) const override;
  void assembleUnconstrained(State& state, const Vec3& gravity, std::span<const Vec3> force,
                             std::span<const TieLoad> ties, const Surroundings& loads) override;
  void precomputeCompliance(std::span<const int> nodes) override { rest_.precomputeCompliance(nodes); }
  [[nodiscard]] Mat3 rotation(const State& state, int node) const override;
  [[nodiscard]] Mat3 block(int a, int b) const override { return rest_.block(a, b); }
  void blocks(std::span<const int> a, std::span<const int> b, std::span<double> out) const override {
    rest_.blocks(a, b, out);
  }
  bool advance(State& state) override;
  void stop(State& state) const override;

 private:
  friend class FatSkin;
  std::size_t index_;
  SolidSolver::Settings settings_;
  Executor& executor_;
  FatBody fat_;
  bool stale_ = true;
  bool changed_ = true;  ///< the surface, since its skin followed
  RestCompliance rest_;
  std::vector<Attachment> load_;
};

class FatSkin final : public Skin {
 public:
  explicit FatSkin(FatMotion& motion) : motion_(motion) {}

  bool follow(const State& state) override;
  [[nodiscard]] const ContactSurface& surface() const override { return motion_.fat_.contact().surface(); }
  void place(const State& state, std::vector<Vec3>& out) const override;
  [[nodiscard]] SolidSolver::Impulse influence(const std::array<int, 3>& corner, const Vec3& weight) const override;
  [[nodiscard]] bool exists(int node) const override { return motion_.fat_.contact().exists(node); }

 private:
  FatMotion& motion_;
};

}  // namespace calot
