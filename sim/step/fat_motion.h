// SPDX-License-Identifier: GPL-3.0-or-later
// Fat in the step. Internal to this folder.
#pragma once

#include <vector>

#include "sim/fat/fat_body.h"
#include "sim/solid/rest_compliance.h"
#include "sim/step/solid_body.h"

namespace calot {

class FatMotion final : public SolidBody {
 public:
  FatMotion(const Model& model, std::size_t fat, const SolidSolver::Settings& settings,
            const SolidSolver::Settings& responses, Executor& executor, const ComplianceShelf& shelf);

  /// To be called when the State was replaced.
  void invalidate() { stale_ = true; }
  /// Takes up a replaced State; remembers where the tissue is for the strokes of this step.
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
