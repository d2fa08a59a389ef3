// SPDX-License-Identifier: GPL-3.0-or-later
// A body that conjugate gradients solve, alone or joined with others: an organ, fat. Internal to this folder.
#pragma once

#include <span>
#include <vector>

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

}  // namespace calot
