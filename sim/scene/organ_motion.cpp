// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a step that moves organs without contact, and closes their books.
#include <algorithm>
#include <cmath>

#include "sim/scene/stepper_workspace.h"

namespace calot {

using namespace stepping;

namespace {

constexpr double quietSpeed = 1e-5;  ///< m/s

}  // namespace

/// Wakes the organs that a shaft is about to touch, and computes the free motion of all that are awake.
void Stepper::Workspace::wakeAndMove(State& state) {
  for (const ContactRow& row : rows) {
    const double approach = share[row.hand] * row.direction.dot(remaining[row.hand]);
    if (row.contact.gap + std::min(approach, 0.0) < slack) state.organ[row.organ].quietSteps = 0;
  }
  moved.assign(model.organs().size(), false);
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    OrganResult& out = result.organ[o];
    out.asleep = model.scene().solver.sleeping && state.organ[o].quietSteps >= quietSteps;
    out.residual = 0.0;
    out.iterations = 0;
    if (out.asleep) continue;
    moved[o] = true;
    const SolveReport report =
        solver[o].freeMotion(model.organs()[o].solid, state.organ[o], model.scene().gravity, {}, settings, executor);
    out.residual = report.residual;
    out.iterations = report.iterations;
    if (!report.converged) {
      result.misses |= miss::solver;
      emit(EventKind::solverMiss, 255, static_cast<std::uint16_t>(o), Vec3::Zero(), report.residual);
    }
  }
}

void Stepper::Workspace::finishOrgans(State& state) {
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    SolidState& organ = state.organ[o];
    OrganResult& out = result.organ[o];
    const OrganModel& fixed = model.organs()[o];
    out.largestSpeed = 0.0;
    if (moved[o]) {
      double speed = 0.0;
      double displacement = 0.0;
      for (std::size_t n = 0; n < organ.position.size(); ++n) {
        speed = std::max(speed, organ.velocity[n].squaredNorm());
        displacement = std::max(displacement, (organ.position[n] - fixed.solid.rest()[n]).squaredNorm());
      }
      out.largestSpeed = std::sqrt(speed);
      organ.largestDisplacement = std::sqrt(displacement);
      organ.volume = fixed.solid.elements().volume(organ.position);
      bool touched = false;
      for (const ContactRow& row : rows) touched = touched || row.organ == o;
      organ.quietSteps = !touched && out.largestSpeed < quietSpeed ? organ.quietSteps + 1 : 0;
      if (model.scene().solver.sleeping && organ.quietSteps >= quietSteps) {
        std::fill(organ.velocity.begin(), organ.velocity.end(), Vec3::Zero());
      }
    }
    out.largestDisplacement = organ.largestDisplacement;
    out.volume = organ.volume;
  }
}

}  // namespace calot
