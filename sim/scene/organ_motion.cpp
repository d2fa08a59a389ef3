// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a step that moves organs without contact, and closes their books.
#include <algorithm>
#include <cmath>

#include "sim/scene/stepper_workspace.h"

namespace calot {

using namespace stepping;

namespace {

constexpr double quietSpeed = 1e-5;   ///< m/s
constexpr double wakingForce = 1e-3;  ///< of one organ on another (N)

}  // namespace

/// Wakes the organs that an instrument is about to touch or holds, and those that another organ pressed in the last
/// step.
void Stepper::Workspace::wake(State& state) {
  for (const ContactBlock& block : blocks) {
    const double approach = block.tool[0].dot(stretch[block.hand]);
    if (block.kind == BlockKind::ball || block.gap[0] + std::min(approach, 0.0) < slack) {
      state.organ[block.organ].quietSteps = 0;
    }
  }
  for (std::size_t i = 0; i < state.tissue.key.size(); ++i) {
    const std::uint64_t pair = state.tissue.key[i] >> 40U;
    if (!(state.tissue.force[i] > wakingForce) || pair >= model.tissuePairs().size()) continue;
    state.organ[model.tissuePairs()[pair].a].quietSteps = 0;
    state.organ[model.tissuePairs()[pair].b].quietSteps = 0;
  }
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    moved[o] = !(model.scene().solver.sleeping && state.organ[o].quietSteps >= quietSteps);
  }
  wakeJoined(state);
}

/// Free motion of all organs that are awake, under the contact forces that the last step left.
void Stepper::Workspace::moveFreely(State& state) {
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    OrganResult& out = result.organ[o];
    out.asleep = !moved[o];
    out.residual = 0.0;
    out.iterations = 0;
    if (out.asleep) continue;
    nodal[o].clear();
    addForces(o, carried, 1.0, nodal[o]);
    gatherAttachments(state, o);
    const SolveReport report = solver[o].freeMotion(model.organs()[o].solid, state.organ[o], model.scene().gravity,
                                                    nodal[o], settings, executor, {attachments, {}});
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
      organ.volume = fixed.solid.volume(organ.position);
      bool touched = false;
      for (const ContactBlock& block : blocks) {
        touched = touched || (block.hand != ContactBlock::nobody && block.organ == o);
      }
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
