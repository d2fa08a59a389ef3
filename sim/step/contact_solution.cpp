// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/stages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "sim/step/contact_block.h"

namespace calot {

namespace {

/// Tissue that responds by more than this multiple of what W predicts: a change of forces is taken back in part. Larger
/// lets the iteration diverge on soft folds; smaller costs solves. Assumed.
constexpr double maxSurprise = 2.0;
constexpr int maxDimpleSteps = 5;  ///< of Newton's method on the dimples, in each pass
constexpr double minShare = 1e-3;  ///< tissue that responds by less than this share: rounding, not a response

}  // namespace

/// Impulses of the change of forces on a body's nodes, and of the vessels that are grown to it; empty: none.
void ContactSolution::gatherImpulses(Bodies& bodies, const ContactSystem& contact, std::size_t which) {
  nodal_.clear();
  addNodalForces(contact.blocks, which, bodies[which].nodes(), change_, bodies.step(), nodal_);
  bodies.joined().passOn(which, nodal_);
}

void ContactSolution::applyToGroup(Bodies& bodies, const Activity& activity, const ContactSystem& contact,
                                   std::size_t group, StepLog& log) {
  const std::vector<std::size_t>& members = bodies.joined().groups()[group];
  if (!activity.awake[members[0]]) return;  // then all sleep
  bool pushed = false;
  for (const std::size_t b : members) {
    gatherImpulses(bodies, contact, b);
    pushed = pushed || !nodal_.empty();
    bodies.joined().solid(b).solver().takeImpulses(nodal_);
  }
  if (!pushed && !bodies.joined().isOpen(group)) return;
  const SolveReport report = bodies.joined().applyImpulses(group, loose_);
  if (!log.hasMissed(miss::solver)) reportMiss(bodies, members[0], report, log);
}

/// Applies a change of forces to all bodies at once: vessels, then organs and fat with everything tied to them.
void ContactSolution::applyContactImpulses(Bodies& bodies, const Activity& activity, const ContactSystem& contact,
                                           StepLog& log) {
  for (std::size_t tree = 0; tree < bodies.vessels().size(); ++tree) {
    const std::size_t which = bodies.organs() + tree;
    if (!activity.awake[which]) continue;
    gatherImpulses(bodies, contact, which);
    if (!nodal_.empty()) bodies.vessels()[tree]->applyImpulses(nodal_);
  }
  for (std::size_t group = 0; group < bodies.joined().groups().size(); ++group) {
    applyToGroup(bodies, activity, contact, group, log);
  }
}

/// Gaps after change_ was applied, `response_` of the tissue and what W predicted. @return s.y and s.W s for the change
/// s and the response y
std::array<double, 2> ContactSolution::measureResponse(Bodies& bodies, const Activity& activity,
                                                       const InstrumentTravels& travels, ContactSystem& contact) {
  const std::size_t rows = contact.rows;
  measureGaps(model_, bodies, activity, travels, contact);
  expected_.assign(rows, 0.0);
  double measured = 0.0;
  double predicted = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    double coupled = 0.0;
    for (std::size_t j = 0; j < rows; ++j) {
      expected_[i] += contact.tissueCompliance[i * rows + j] * change_[j];
      coupled += contact.couplingCompliance[i * rows + j] * change_[j];
    }
    response_[i] = contact.trueGap[i] - gapBefore_[i] - coupled;
    if (!contact.pressed.empty()) response_[i] -= contact.dimpleGap[i] - dimpleBefore_[i];
    measured += change_[i] * response_[i];
    predicted += change_[i] * expected_[i];
  }
  return {measured, predicted};
}

/// Applies the change s from `carried` to `lambda` and measures the tissue's response y. Where y is W s, nothing else
/// happens. Where s.y is more than twice s.W s, going on like that would lead away from the solution: the change is
/// taken back to the share for which the response is as large as predicted. Then W is corrected so that it gives this
/// response, and the next steps get to know it. Of a change that moves gaps by less than their tolerance nothing is
/// learned: in its response is what the solves before had left open, too.
void ContactSolution::updateComplianceEstimate(Bodies& bodies, const Activity& activity,
                                               const InstrumentTravels& travels, ContactSystem& contact, StepLog& log) {
  const std::size_t rows = contact.rows;
  gapBefore_ = contact.trueGap;
  response_.resize(rows);
  for (std::size_t i = 0; i < rows; ++i) change_[i] = contact.lambda[i] - contact.carried[i];
  applyContactImpulses(bodies, activity, contact, log);
  auto [measured, predicted] = measureResponse(bodies, activity, travels, contact);
  const auto isSmall = [&](double gap) { return !(std::abs(gap) > (getenv("SMALLF") ? atof(getenv("SMALLF")) : 1.0) *model_.scene().solver.gapTolerance); };
  if (std::all_of(expected_.begin(), expected_.end(), isSmall)) predicted = 0.0;
  if (predicted > 0.0 && measured > maxSurprise * predicted) {
    const double back = predicted / measured - 1.0;
    for (std::size_t i = 0; i < rows; ++i) change_[i] *= back;
    applyContactImpulses(bodies, activity, contact, log);
    for (std::size_t i = 0; i < rows; ++i) {
      change_[i] *= (1.0 + back) / back;
      contact.lambda[i] = contact.carried[i] + change_[i];
    }
    const std::array<double, 2> again = measureResponse(bodies, activity, travels, contact);
    measured = again[0];
    predicted = again[1];
  }
  contact.carried = contact.lambda;
  if (!(predicted > 0.0) || !(measured > minShare * predicted)) {
    if (!contact.pressed.empty()) sumCompliances(contact);
    return;
  }
  correctCompliance(change_, response_, expected_, contact);
  learnResponse(change_, response_, contact);
  sumCompliances(contact);
}

/// Forces for the present free gaps. Dimples are not linear in the forces: their compliance is evaluated at those that
/// come out (Newton's method) until it fits them.
void ContactSolution::solve(const ContactProblem& problem, ContactSystem& contact, ContactResult& result) {
  const SolverDescription& scene = model_.scene().solver;
  const std::size_t m = contact.pressed.size();
  for (int step = 0;; ++step) {
    forces_ = contact.lambda;
    const ContactReport report =
        solver_.solve(problem, contact.lambda, gap_, scene.contactTolerance, scene.contactIterations);
    result.iterations += report.sweeps;
    result.newtonSteps += report.newtonSteps;
    result.residual = report.residual;
    if (m == 0) return;
    expected_.assign(m, 0.0);
    for (std::size_t i = 0; i < m; ++i) {
      expected_[i] = contact.dimpleGap[contact.blocks[contact.pressed[i]].row];
      for (std::size_t j = 0; j < m; ++j) {
        const std::size_t row = contact.blocks[contact.pressed[j]].row;
        expected_[i] += contact.dimpleCompliance[i * m + j] * (contact.lambda[row] - forces_[row]);
      }
    }
    sumCompliances(contact);
    double worst = 0.0;
    for (std::size_t i = 0; i < m; ++i) {
      const std::size_t row = contact.blocks[contact.pressed[i]].row;
      const double off = contact.dimpleGap[row] - expected_[i];
      gap_[row] += off;
      worst = std::max(worst, std::abs(off));
    }
    contact.freeGap = gap_;
    for (std::size_t j = 0; j < contact.rows; ++j) {
      for (std::size_t i = 0; i < contact.rows; ++i) {
        contact.freeGap[i] -= contact.compliance[j * contact.rows + i] * contact.lambda[j];
      }
    }
    if (worst <= scene.contactTolerance || step == maxDimpleSteps) return;
  }
}

void ContactSolution::run(Bodies& bodies, const Activity& activity, const InstrumentTravels& travels,
                          ContactSystem& contact, ContactResult& result, StepLog& log) {
  const SolverDescription& scene = model_.scene().solver;
  const std::size_t rows = contact.rows;
  result.blocks = static_cast<std::uint32_t>(contact.blocks.size());
  result.rows = static_cast<std::uint32_t>(rows);
  contact.freeGap.resize(rows);
  gap_.resize(rows);
  change_.resize(rows);
  loose_ = false;
  if (rows == 0 && bodies.joined().isAnyOpen()) applyContactImpulses(bodies, activity, contact, log);
  const ContactProblem problem{contact.kinds, contact.limits, contact.compliance, contact.freeGap};
  for (result.passes = 0; rows > 0;) {
    // Free gaps that give back the true ones under the present forces.
    std::fill(contact.freeGap.begin(), contact.freeGap.end(), 0.0);
    evaluateGaps(problem, contact.lambda, gap_);
    for (std::size_t i = 0; i < rows; ++i) contact.freeGap[i] = contact.trueGap[i] - gap_[i];
    // An estimate that learned wrongly of a row that it hardly moves would call a force beside an open gap closed.
    result.error = naturalResidual({contact.kinds, contact.limits, contact.ruler, contact.freeGap}, contact.lambda, contact.trueGap);
    const bool closed = result.error <= std::max((getenv("GAPF") ? atof(getenv("GAPF")) : 1.0) * scene.gapTolerance, scene.contactTolerance) &&
                        result.residual <= scene.contactTolerance;
    // One pass is always made: slip that stays below the tolerance would add up, step by step.
    static const int least = getenv("LEAST") ? atoi(getenv("LEAST")) : 1;
    if (result.passes == scene.contactPasses || (closed && (int)result.passes >= least)) break;
    dimpleBefore_ = contact.dimpleGap;
    solve(problem, contact, result);
    ++result.passes;
    loose_ = result.passes == 1 && scene.contactPasses > 1;  // another follows
    updateComplianceEstimate(bodies, activity, travels, contact, log);
  }
  if (result.residual > scene.contactTolerance) {
    log.miss(miss::contact);
    log.emit(EventKind::contactMiss, StepLog::noHand, 0, Vec3::Zero(), result.residual);
  }
}

void reduceToHand(const Bodies& bodies, const State& state, const InstrumentTravels& travels,
                  const ContactSystem& contact, std::size_t hand, std::uint64_t step, ContactSet& set) {
  set.step = static_cast<std::int64_t>(step);
  set.reference = travels[hand].reference;
  set.kind.clear();
  set.limit.clear();
  set.direction.clear();
  set.free.clear();
  set.rate.clear();
  set.compliance.clear();
  set.lambda.clear();
  for (const ContactBlock& block : contact.blocks) {
    const std::array<ToolRow, 3>* const tool = block.toolOf(hand);
    if (tool == nullptr) continue;
    set.kind.push_back(block.kind);
    set.limit.push_back(block.limit);
    Vec3 velocity = Vec3::Zero();
    if (const PushedBody* const pushed = block.against())
      velocity = pushed->place.of(bodies[pushed->body].velocity(state));
    for (std::size_t k = 0; k < block.rows(); ++k) {
      const std::size_t i = block.row + k;
      double free = contact.freeGap[i] - (*tool)[k].dot(travels[hand].stretch);
      for (const ContactBlock& b : contact.blocks) {
        for (std::size_t j = b.row; j < b.row + b.rows(); ++j) {
          if (b.toolOf(hand) != nullptr) {
            set.compliance.push_back(contact.compliance[i * contact.rows + j]);
          } else {
            free += contact.compliance[i * contact.rows + j] * contact.lambda[j];
          }
        }
      }
      set.direction.push_back((*tool)[k]);
      set.free.push_back(free);
      double rate = -block.direction[k].dot(velocity);
      if (block.as<ToolOnTool>() != nullptr) {
        const Vec3 gone = state.hand[1 - hand].instrument.position - travels[1 - hand].before.position;
        rate += (*block.toolOf(1 - hand))[k].head<3>().dot(gone) / bodies.step();
      }
      set.rate.push_back(rate);
      set.lambda.push_back(contact.lambda[i]);
    }
  }
}

void ContactResponse::integrateTissue(Surfaces& surfaces, Bodies& bodies, const Activity& activity, State& state,
                                      StepLog& log) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!activity.awake[b]) continue;
    diverged_[b] = !bodies[b].advance(state);
    if (diverged_[b]) reportMiss(bodies, b, {0, 1e300, false}, log);
    if (const double speed = bodies[b].heldBack(); speed > 0.0) {
      log.miss(miss::speed);
      log.emit(EventKind::motionHeldBack, StepLog::noHand, bodies.firstStructure(b), Vec3::Zero(), speed);
    }
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (activity.awake[b]) surfaces.markBodyStale(b);
  }
}

/// The instrument goes where the virtual coupling and the contact forces are in balance.
void ContactResponse::integrateInstrument(std::size_t hand, const InstrumentTravel& travel,
                                          const ContactSystem& contact, State& state, HandResult& result) const {
  InstrumentState& instrument = state.hand[hand].instrument;
  const HandDescription& description = model_.scene().hands[hand];
  ToolRow push = ToolRow::Zero();
  for (const ContactBlock& block : contact.blocks) {
    const std::array<ToolRow, 3>* const tool = block.toolOf(hand);
    if (tool == nullptr) continue;
    for (std::size_t k = 0; k < block.rows(); ++k) push += contact.lambda[block.row + k] * (*tool)[k];
  }
  Vec3 way = travel.stretch.head<3>() + push.head<3>() / description.couplingStiffness;
  const double size = way.norm();
  if (size > maxSlide) way *= maxSlide / size;
  const double roll =
      std::clamp(travel.stretch[3] + push[3] / description.rollStiffness, -maxRollStretch, maxRollStretch);
  const Pose pose = movedTool(description.port, simulatedPose(instrument), way, roll);
  instrument.position = pose.position;
  instrument.orientation = pose.orientation;
  result.contactForce = push.head<3>();
  result.contactTorque = push[3];
}

void ContactResponse::run(Surfaces& surfaces, Bodies& bodies, const Activity& activity,
                          const InstrumentTravels& travels, const ContactSystem& contact, State& state,
                          ContactSets& sets, StepResult& result, StepLog& log) {
  storeWarmStart(contact, state);
  storeDimples(model_, bodies.step(), contact, state);
  integrateTissue(surfaces, bodies, activity, state, log);
  for (std::size_t h = 0; h < handCount; ++h) integrateInstrument(h, travels[h], contact, state, result.hand[h]);
  for (std::size_t h = 0; h < handCount; ++h) {
    reduceToHand(bodies, state, travels, contact, h, result.step, sets[h]);
  }
  surfaces.refresh(state);
  for (std::size_t h = 0; h < handCount; ++h) resolver_.run(surfaces, h, state, result.contact);
}

}  // namespace calot
