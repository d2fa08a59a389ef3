// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/unconstrained_motion.h"

#include <algorithm>

namespace calot {

/// Where an end of a tie is (m).
Vec3 UnconstrainedMotion::endOf(const Bodies& bodies, const State& state, const Tie& tie, std::size_t side) const {
  const std::size_t which = tie.body[side];
  const Vec3 place = tie.place[side].of(bodies[which].position(state));
  if (side == 1 || tie.offset.isZero(0.0)) return place;
  if (which < model_.organs().size()) {
    return place + rotationOf(state.organ[which].rotation, tie.place[0].element) * tie.offset;
  }
  const BeamState& vessels = state.vessel[which - model_.organs().size()];
  return place + vessels.orientation[static_cast<std::size_t>(tie.place[0].node[0])] * tie.offset;
}

/// Springs between a body and others.
void UnconstrainedMotion::gatherTies(const Bodies& bodies, const Activity& activity, const State& state,
                                     std::size_t which) {
  tieLoads_.clear();
  for (const auto& [number, side] : bodies.springsOf(which)) {
    const Tie& tie = model_.ties()[number];
    const double share = bodies.shareLeft(tie);
    if (!(share > 0.0)) continue;
    const std::size_t other = tie.body[1 - side];
    const std::span<const Vec3> velocity =
        solved_[other] && activity.awake[other] ? bodies[other].freeVelocity() : bodies[other].velocity(state);
    Vec3 target = endOf(bodies, state, tie, 1 - side);
    if (side == 0) target -= endOf(bodies, state, tie, 0) - tie.place[0].of(bodies[which].position(state));
    tieLoads_.push_back(
        {tie.place[side], share * tie.stiffness, share * tie.damping, target, tie.place[1 - side].of(velocity)});
  }
}

/// An assistant's springs: their far ends follow the scene's displacement, smoothly.
void UnconstrainedMotion::gatherRetractions(const Bodies& bodies, const State& state, std::size_t organ) {
  const double time = static_cast<double>(state.clock.step) * bodies.step();
  for (std::size_t r = 0; r < model_.retractions().size(); ++r) {
    const RetractionModel& retraction = model_.retractions()[r];
    const RetractionDescription& d = model_.scene().retraction[r];
    if (retraction.organ != organ || time < d.start) continue;
    const double s = std::min((time - d.start) / d.duration, 1.0);
    const Vec3 gone = s * s * (3.0 - 2.0 * s) * d.displacement;
    const Vec3 speed = 6.0 * s * (1.0 - s) / d.duration * d.displacement;
    const auto share = 1.0 / static_cast<double>(retraction.node.size());
    for (const int node : retraction.node) {
      MaterialPoint place;
      place.node[0] = node;
      place.weight[0] = 1.0;
      place.count = 1;
      const Vec3& rest = model_.organs()[organ].solid.rest()[static_cast<std::size_t>(node)];
      tieLoads_.push_back({place, share * d.stiffness, share * d.damping, rest + gone, speed});
    }
  }
}

void UnconstrainedMotion::gatherLoads(Bodies& bodies, const ContactSystem& contact, const Activity& activity,
                                      const State& state, std::size_t which) {
  nodal_.clear();
  addNodalForces(contact.blocks, which, bodies[which].nodes(), contact.carried, 1.0, nodal_);
  attachments_.clear();
  joints_.clear();
  gatherTies(bodies, activity, state, which);
  if (which >= bodies.organs()) return;
  bodies.joined().addAttachments(which, attachments_);
  gatherRetractions(bodies, state, which);
  for (TieCoupling& c : bodies.couplings()) {
    if (c.organ() != which) continue;
    c.begin(state, bodies.all());
    joints_.push_back(c.joint());
  }
}

void UnconstrainedMotion::reportMiss(const Bodies& bodies, std::size_t which, const SolveReport& report, StepLog& log) {
  if (report.converged) return;
  log.miss(miss::solver);
  log.emit(EventKind::solverMiss, StepLog::noHand, bodies.firstStructure(which), Vec3::Zero(), report.residual);
}

/// Vessels or fat.
void UnconstrainedMotion::solveBody(Bodies& bodies, const ContactSystem& contact, const Activity& activity,
                                    std::size_t which, State& state, StepResult& result, StepLog& log) {
  SolveReport report;
  if (activity.awake[which]) {
    gatherLoads(bodies, contact, activity, state, which);
    report =
        bodies[which].solveUnconstrained(state, model_.scene().gravity, nodal_, tieLoads_, {attachments_, {}, joints_});
    reportMiss(bodies, which, report, log);
  }
  solved_[which] = true;
  if (which < bodies.firstFat()) return;
  FatResult& out = result.fat[which - bodies.firstFat()];
  out.residual = report.residual;
  out.iterations = report.iterations;
}

void UnconstrainedMotion::solveOrgans(Bodies& bodies, const ContactSystem& contact, const Activity& activity,
                                      std::size_t group, State& state, StepResult& result, StepLog& log) {
  const std::vector<std::size_t>& organs = bodies.joined().groups()[group];
  SolveReport report;
  if (activity.awake[organs[0]]) {  // then all are
    for (const std::size_t o : organs) {
      gatherLoads(bodies, contact, activity, state, o);
      bodies.organ(o).assembleUnconstrained(state, model_.scene().gravity, nodal_, tieLoads_,
                                            {attachments_, {}, joints_});
    }
    report = bodies.joined().solveUnconstrained(group);
    for (TieCoupling& c : bodies.couplings()) {
      if (std::find(organs.begin(), organs.end(), c.organ()) != organs.end()) c.pull(bodies.all());
    }
    reportMiss(bodies, organs[0], report, log);
  }
  for (const std::size_t o : organs) {
    solved_[o] = true;
    OrganResult& out = result.organ[o];
    out.asleep = !activity.awake[o];
    out.residual = report.residual;
    out.iterations = report.iterations;
  }
}

void UnconstrainedMotion::run(Bodies& bodies, const ContactSystem& contact, const Activity& activity, State& state,
                              StepResult& result, StepLog& log) {
  std::fill(solved_.begin(), solved_.end(), false);
  bodies.joined().linearise(state, activity.awake);
  const auto solve = [&](std::size_t from, std::size_t end) {
    for (std::size_t b = from; b < end; ++b) solveBody(bodies, contact, activity, b, state, result, log);
  };
  solve(bodies.organs(), bodies.firstFat());
  for (std::size_t group = 0; group < bodies.joined().groups().size(); ++group) {
    solveOrgans(bodies, contact, activity, group, state, result, log);
  }
  solve(bodies.firstFat(), bodies.size());
}

}  // namespace calot
