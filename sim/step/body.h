// SPDX-License-Identifier: GPL-3.0-or-later
// Mechanics and skin of a body that can be touched, as the step sees them: an organ, vessels, fat. Internal to
// this folder.
//
// A body is solved as one system; a structure has a name and a skin. Vessels that grow out of one another are
// one body and several structures; everything else is one of each.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim/contact/surface_patches.h"
#include "sim/fat/fat_body.h"
#include "sim/scene/state.h"
#include "sim/solid/solid.h"
#include "sim/vessel/beam_solver.h"
#include "sim/vessel/tube_surface.h"

namespace calot {

/// A spring and a damper between a place of a body and one of another, linearised over a step, implicit on the side of
/// the body that it is given to.
struct TieLoad {
  MaterialPoint place;
  double stiffness = 0.0;        ///< N/m
  double damping = 0.0;          ///< N s/m
  Vec3 target = Vec3::Zero();    ///< where the other end is now (m)
  Vec3 velocity = Vec3::Zero();  ///< at which it moves in this step, as far as that is known (m/s)
};

class Body {
 public:
  Body() = default;
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;
  virtual ~Body() = default;

  [[nodiscard]] virtual std::size_t nodes() const = 0;
  [[nodiscard]] virtual std::span<const Vec3> position(const State& state) const = 0;
  [[nodiscard]] virtual std::span<const Vec3> velocity(const State& state) const = 0;
  [[nodiscard]] virtual std::uint32_t& quietSteps(State& state) const = 0;
  [[nodiscard]] std::uint32_t quietSteps(const State& state) const { return quietSteps(const_cast<State&>(state)); }

  /// Velocities that the step ends with, as far as they are known. @pre its free motion was solved
  [[nodiscard]] virtual std::span<const Vec3> freeVelocity() const = 0;
  /// Works out what block() needs for these nodes. @pre its free motion was solved
  virtual void precomputeCompliance(std::span<const int> nodes) = 0;
  /// Works out ahead, besides, what the first step would have to.
  virtual void precompute() {}
  /// The compliance on which contact is decided: velocity of node a for an impulse on node b is about
  /// rotation(a) block(a, b) rotation(b)^T.
  [[nodiscard]] virtual Mat3 rotation(const State& state, int node) const = 0;
  [[nodiscard]] virtual Mat3 block(int a, int b) const = 0;
  /// block() of some nodes and others, row-major, at 9 (i b.size() + j). @param out as many numbers or more
  virtual void blocks(std::span<const int> a, std::span<const int> b, std::span<double> out) const;
  /// Goes where the step leads. @return false when some node had to be stopped
  virtual bool advance(State& state) = 0;
  /// The largest speed that the last advance() held back, for no tissue moves as fast (m/s); 0: none.
  [[nodiscard]] virtual double heldBack() const = 0;
  /// Stops it, to sleep.
  virtual void stop(State& state) const = 0;
};

inline void Body::blocks(std::span<const int> a, std::span<const int> b, std::span<double> out) const {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Mat3 own = block(a[i], b[j]);
      for (std::size_t k = 0; k < 9; ++k) {
        out[9 * (i * b.size() + j) + k] = own(static_cast<int>(k / 3), static_cast<int>(k % 3));
      }
    }
  }
}

class Skin {
 public:
  Skin() = default;
  Skin(const Skin&) = delete;
  Skin& operator=(const Skin&) = delete;
  virtual ~Skin() = default;

  /// Adopts the state's topology. @return true if it differs from the last call's
  virtual bool follow(const State& state) = 0;
  /// @pre follow(), as for all that comes
  [[nodiscard]] virtual const ContactSurface& surface() const = 0;
  /// Positions of its vertices (m).
  virtual void place(const State& state, std::vector<Vec3>& out) const = 0;
  /// True if this vertex exists now.
  [[nodiscard]] virtual bool exists(int /*node*/) const { return true; }
  /// A vertex in the reference configuration (m).
  [[nodiscard]] virtual Vec3 rest(int node) const = 0;
  /// A place on the skin in terms of the body's nodes.
  [[nodiscard]] virtual SolidSolver::Impulse influence(const std::array<int, 3>& corner, const Vec3& weight) const = 0;
};

/// Adds a share of a node to a place that may have it already. @pre it has room
inline void addShare(SolidSolver::Impulse& place, int node, double share) {
  if (share == 0.0) return;
  std::size_t k = 0;
  while (k < place.count && place.node[k] != node) ++k;
  if (k == place.count) place.node[place.count++] = node;
  place.weight[k] += share;
}

/// A body that conjugate gradients solve, alone or joined with others: an organ, fat.
class SolidBody : public Body {
 public:
  [[nodiscard]] std::size_t nodes() const override { return model_.nodes(); }
  [[nodiscard]] std::span<const Vec3> position(const State& state) const override { return solidOf(state).position; }
  [[nodiscard]] std::span<const Vec3> velocity(const State& state) const override { return solidOf(state).velocity; }
  [[nodiscard]] std::uint32_t& quietSteps(State& state) const override { return solidOf(state).quietSteps; }
  /// Linearises the body by itself. May run while others read State.
  void linearise(const State& state);
  /// Assembles the free motion of a step under gravity, forces on the nodes (N; may be empty), springs to other bodies
  /// and loads that were linearised elsewhere, for solver(). @pre linearise() at this State
  void load(State& state, const Vec3& gravity, std::span<const Vec3> force, std::span<const TieLoad> ties,
            const Surroundings& loads);
  [[nodiscard]] SolidSolver& solver() { return solver_; }
  [[nodiscard]] std::span<const Vec3> freeVelocity() const override { return solver_.freeVelocity(); }
  void precomputeCompliance(std::span<const int> nodes) override { rest_.precomputeCompliance(nodes); }
  [[nodiscard]] Mat3 block(int a, int b) const override { return rest_.block(a, b); }
  void blocks(std::span<const int> a, std::span<const int> b, std::span<double> out) const override {
    rest_.blocks(a, b, out);
  }
  bool advance(State& state) override { return solver_.advance(model_, solidOf(state), {}, settings_.step); }
  [[nodiscard]] double heldBack() const override { return solver_.heldBack(); }
  void stop(State& state) const override;

 protected:
  SolidBody(const SolidModel& model, const SolidSolver::Settings& settings, const SolidSolver::Settings& responses,
            Executor& executor, const Surroundings& rest, const ComplianceShelf& shelf)
      : model_(model), settings_(settings), executor_(executor), rest_(model, responses, executor, rest, shelf) {}

  /// Its part of a State.
  [[nodiscard]] virtual const SolidState& solidOf(const State& state) const = 0;
  [[nodiscard]] SolidState& solidOf(State& state) const {
    return const_cast<SolidState&>(solidOf(std::as_const(state)));
  }
  /// Share that is left of each cube; empty: all of them.
  [[nodiscard]] virtual std::span<const double> fill() const { return {}; }

  const SolidModel& model_;
  SolidSolver::Settings settings_;
  Executor& executor_;
  SolidSolver solver_;

 private:
  RestCompliance rest_;
  std::vector<Attachment> load_;
};

class OrganBody final : public SolidBody {
 public:
  OrganBody(const Model& model, std::size_t organ, const SolidSolver::Settings& settings,
            const SolidSolver::Settings& responses, Executor& executor, const ComplianceShelf& shelf)
      : SolidBody(model.organs()[organ].solid, settings, responses, executor, {}, shelf), organ_(organ) {}

  void precompute() override { solver_.precompute(model_, settings_, executor_); }
  [[nodiscard]] Mat3 rotation(const State& state, int node) const override {
    return nodeRotation(model_, solidOf(state), node).toRotationMatrix();
  }

 private:
  [[nodiscard]] const SolidState& solidOf(const State& state) const override { return state.organ[organ_]; }

  std::size_t organ_;
};

class OrganSkin final : public Skin {
 public:
  OrganSkin(const Model& model, std::size_t organ) : organ_(organ), model_(model.organs()[organ]) {}

  bool follow(const State& state) override;
  [[nodiscard]] const ContactSurface& surface() const override { return model_.surface; }
  void place(const State& state, std::vector<Vec3>& out) const override;
  [[nodiscard]] Vec3 rest(int node) const override { return model_.skin[static_cast<std::size_t>(node)]; }
  [[nodiscard]] SolidSolver::Impulse influence(const std::array<int, 3>& corner, const Vec3& weight) const override;

 private:
  std::size_t organ_;
  const OrganModel& model_;
};

class FatMotion final : public SolidBody {
 public:
  FatMotion(const Model& model, std::size_t fat, const SolidSolver::Settings& settings,
            const SolidSolver::Settings& responses, Executor& executor, const ComplianceShelf& shelf);

  /// To be called when the State was replaced.
  void invalidate() { stale_ = true; }
  /// Adopts a replaced State; stores the tissue's position for the strokes of this step.
  void beginStep(const State& state);
  FatStroke stroke(State& state, std::span<const SweptCapsule> tool, double rise);
  /// FatBody::tear()
  FatStroke tear(State& state);
  /// FatBody::joins()
  [[nodiscard]] bool joins(std::span<const std::uint32_t> thing, std::uint32_t things) {
    return fat_.joins(thing, things);
  }
  [[nodiscard]] const FatBody& fat() const { return fat_; }
  [[nodiscard]] Mat3 rotation(const State& state, int node) const override {
    return fat_.rotation(state.fat[index_], node);
  }

 private:
  friend class FatSkin;
  [[nodiscard]] const SolidState& solidOf(const State& state) const override { return state.fat[index_].solid; }
  [[nodiscard]] std::span<const double> fill() const override { return fat_.fill(); }

  std::size_t index_;
  FatBody fat_;
  bool stale_ = true;
  bool changed_ = true;  ///< the surface, since its skin followed
};

class FatSkin final : public Skin {
 public:
  explicit FatSkin(FatMotion& motion) : motion_(motion) {}

  bool follow(const State& state) override;
  [[nodiscard]] const ContactSurface& surface() const override { return motion_.fat_.contact().surface(); }
  void place(const State& state, std::vector<Vec3>& out) const override;
  [[nodiscard]] Vec3 rest(int node) const override { return motion_.fat_.contact().rest(node); }
  [[nodiscard]] SolidSolver::Impulse influence(const std::array<int, 3>& corner, const Vec3& weight) const override;
  [[nodiscard]] bool exists(int node) const override { return motion_.fat_.contact().exists(node); }

 private:
  FatMotion& motion_;
};

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
  [[nodiscard]] Vec3 rest(int node) const override { return rest_[static_cast<std::size_t>(node)]; }
  [[nodiscard]] SolidSolver::Impulse influence(const std::array<int, 3>& corner, const Vec3& weight) const override;

 private:
  const BeamModel& beams_;
  std::size_t tree_;
  TubeSurface tube_;
  std::vector<Vec3> rest_;
  std::optional<ContactSurface> contact_;
};

}  // namespace calot
