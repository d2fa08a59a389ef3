// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/stages.h"

#include <algorithm>

namespace calot {

/// Position of an end of a tie (m).
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

/// An assistant's springs: their far ends follow the displacement, smoothly.
void UnconstrainedMotion::gatherRetractions(const Bodies& bodies, const State& state, std::size_t organ) {
  const double time = static_cast<double>(state.clock.step) * bodies.step();
  for (std::size_t r = 0; r < model_.retractions().size(); ++r) {
    const RetractionModel& retraction = model_.retractions()[r];
    const RetractionDescription& d = model_.scene().retraction[r];
    if (retraction.organ != organ || time < d.start) continue;
    const RetractionPlace pull = retractionAt(state.retraction, r, time);
    const Vec3 gone = pull.share * d.displacement;
    const Vec3 speed = pull.rate * d.displacement;
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
  if (which >= bodies.organs() && which < bodies.firstFat()) return;  // vessels, which move first
  bodies.joined().addLoads(which, attachments_, joints_);
  if (which < bodies.organs()) gatherRetractions(bodies, state, which);
}

void reportMiss(const Bodies& bodies, std::size_t which, const SolveReport& report, StepLog& log) {
  if (report.converged) return;
  log.miss(miss::solver);
  log.emit(EventKind::solverMiss, StepLog::noHand, bodies.firstStructure(which), Vec3::Zero(), report.residual);
}

void UnconstrainedMotion::solveVessels(Bodies& bodies, const ContactSystem& contact, const Activity& activity,
                                       std::size_t tree, State& state, StepLog& log) {
  const std::size_t which = bodies.organs() + tree;
  if (activity.awake[which]) {
    gatherLoads(bodies, contact, activity, state, which);
    reportMiss(bodies, which,
               bodies.vessels()[tree]->solveUnconstrained(state, model_.scene().gravity, nodal_, tieLoads_), log);
  }
  solved_[which] = true;
}

/// Organs and fat, and the vessels that they pull.
void UnconstrainedMotion::solveGroup(Bodies& bodies, const ContactSystem& contact, const Activity& activity,
                                     std::size_t group, State& state, StepResult& result, StepLog& log) {
  const std::vector<std::size_t>& members = bodies.joined().groups()[group];
  SolveReport report;
  if (activity.awake[members[0]]) {  // then all are
    for (const std::size_t b : members) {
      gatherLoads(bodies, contact, activity, state, b);
      bodies.joined().solid(b).load(state, model_.scene().gravity, nodal_, tieLoads_, {attachments_, {}, joints_});
    }
    report = bodies.joined().solveUnconstrained(group, contact.rows > 0);
    reportMiss(bodies, members[0], report, log);
  }
  for (const std::size_t b : members) {
    solved_[b] = true;
    if (b >= bodies.firstFat()) {
      FatResult& out = result.fat[b - bodies.firstFat()];
      out.residual = report.residual;
      out.iterations = report.iterations;
      continue;
    }
    OrganResult& out = result.organ[b];
    out.asleep = !activity.awake[b];
    out.residual = report.residual;
    out.iterations = report.iterations;
  }
}

void UnconstrainedMotion::run(Bodies& bodies, const ContactSystem& contact, const Activity& activity, State& state,
                              StepResult& result, StepLog& log) {
  std::fill(solved_.begin(), solved_.end(), false);
  for (std::size_t tree = 0; tree < bodies.vessels().size(); ++tree) {
    solveVessels(bodies, contact, activity, tree, state, log);
  }
  bodies.joined().linearise(state, activity.awake);
  for (std::size_t group = 0; group < bodies.joined().groups().size(); ++group) {
    solveGroup(bodies, contact, activity, group, state, result, log);
  }
}

}  // namespace calot
