// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a step that solves contact: compliance, complementarity, correction, and the problem that is published.
#include <algorithm>

#include "sim/contact/complementarity.h"
#include "sim/instruments/port.h"
#include "sim/scene/stepper_workspace.h"

namespace calot {

using namespace stepping;

namespace {

/// A nodal quantity at the contact's place.
Vec3 atContact(const SolidSolver::Impulse& place, const std::vector<Vec3>& values) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < place.node.size(); ++k)
    sum += place.weight[k] * values[static_cast<std::size_t>(place.node[k])];
  return sum;
}

}  // namespace

/// Free gaps, and the compliance of organs and virtual couplings between all rows that take part.
void Stepper::Workspace::buildProblem(const State& state) {
  const double h = settings.step;
  for (ContactRow& row : rows) {
    double organMoves = 0.0;
    if (moved[row.organ])
      organMoves = h * row.contact.normal.dot(atContact(row.place, solver[row.organ].freeVelocity()));
    const double toolMoves = row.direction.dot(remaining[row.hand]);
    row.free = row.contact.gap + share[row.hand] * toolMoves - organMoves;
    row.freeFull = row.contact.gap + toolMoves - organMoves;
  }
  std::erase_if(rows,
                [&](const ContactRow& row) { return std::min(row.free, row.freeFull) > slack || !moved[row.organ]; });

  const std::size_t n = rows.size();
  response.resize(n);
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    std::vector<std::size_t> mine;
    for (std::size_t i = 0; i < n; ++i) {
      if (rows[i].organ == o) mine.push_back(i);
    }
    for (std::size_t first = 0; first < mine.size(); first += laneCount) {
      const std::size_t last = std::min(mine.size(), first + laneCount);
      impulses.clear();
      for (std::size_t k = first; k < last; ++k) impulses.push_back(rows[mine[k]].place);
      const SolveReport report = solver[o].responses(model.organs()[o].solid, impulses, settings, batch, executor);
      result.organ[o].iterations += report.iterations;
      result.organ[o].residual = std::max(result.organ[o].residual, report.residual);
      if (!report.converged) {
        result.misses |= miss::solver;
        emit(EventKind::solverMiss, 255, static_cast<std::uint16_t>(o), Vec3::Zero(), report.residual);
      }
      for (std::size_t k = first; k < last; ++k) response[mine[k]].swap(batch[k - first]);
    }
  }
  compliance.assign(n * n, 0.0);
  freeGap.resize(n);
  lambda.assign(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    freeGap[i] = rows[i].free;
    const HandState& hand = state.hand[rows[i].hand];
    for (std::size_t k = 0; k < hand.contactKey.size(); ++k) {
      if (hand.contactKey[k] == rows[i].contact.key) lambda[i] = hand.contactForce[k];
    }
    for (std::size_t j = 0; j < n; ++j) {
      double w = 0.0;
      if (rows[i].organ == rows[j].organ) {
        // Both orders of the two solves, so that W is symmetric although each solve stops at its tolerance.
        const double ij = rows[i].contact.normal.dot(atContact(rows[i].place, response[j]));
        const double ji = rows[j].contact.normal.dot(atContact(rows[j].place, response[i]));
        w += h * h * (0.5 * (ij + ji));
      }
      if (rows[i].hand == rows[j].hand) {
        w += rows[i].direction.dot(rows[j].direction) / model.scene().hands[rows[i].hand].couplingStiffness;
      }
      compliance[i * n + j] = w;
    }
  }
}

void Stepper::Workspace::solveContacts(State& state) {
  const SolverDescription& solverSettings = model.scene().solver;
  const ComplementarityReport report = solveComplementarity(
      compliance, freeGap, lambda, solverSettings.contactTolerance, solverSettings.contactIterations);
  result.contact.rows = static_cast<std::uint32_t>(rows.size());
  result.contact.iterations = report.sweeps;
  result.contact.residual = report.residual;
  if (!report.converged) {
    result.misses |= miss::contact;
    emit(EventKind::contactMiss, 255, 0, Vec3::Zero(), report.residual);
  }
  for (HandState& hand : state.hand) {
    hand.contactKey.clear();
    hand.contactForce.clear();
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    state.hand[rows[i].hand].contactKey.push_back(rows[i].contact.key);
    state.hand[rows[i].hand].contactForce.push_back(lambda[i]);
  }
}

/// Moves organs and instruments by what the contact forces do to them.
void Stepper::Workspace::applyForces(State& state) {
  const double h = settings.step;
  correction.resize(model.organs().size());
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    correction[o].clear();
    if (!moved[o]) continue;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].organ != o || !(lambda[i] > 0.0)) continue;
      if (correction[o].empty()) correction[o].assign(model.organs()[o].solid.nodes(), Vec3::Zero());
      const double impulse = -h * lambda[i];
      for (std::size_t n = 0; n < correction[o].size(); ++n) correction[o][n] += impulse * response[i][n];
    }
    if (!solver[o].advance(model.organs()[o].solid, state.organ[o], correction[o], h)) {
      result.misses |= miss::solver;
      emit(EventKind::solverMiss, 255, static_cast<std::uint16_t>(o), Vec3::Zero(), 1e300);
    }
    bounded[o] = false;
  }
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    HandState& s = state.hand[hand];
    const HandDescription& description = model.scene().hands[hand];
    Vec3 push = Vec3::Zero();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].hand == hand) push += lambda[i] * rows[i].direction;
    }
    const Vec3 goal = s.simulatedPosition + share[hand] * remaining[hand] + push / description.couplingStiffness;
    const Pose pose =
        throughPort(description.port, goal, s.realOrientation, axisOf(description.port, s.simulatedPosition));
    s.simulatedPosition = pose.position;
    s.simulatedOrientation = pose.orientation;
    result.hand[hand].contactForce = push;
  }
}

/// The problem of this step, reduced to each hand, for the ticks to come. The other hand's forces stay as they are.
void Stepper::Workspace::publish(const State& state) {
  const std::size_t n = rows.size();
  for (std::size_t h = 0; h < handCount; ++h) {
    ContactSet& set = contactSet[h];
    set.step = static_cast<std::int64_t>(result.step);
    set.reference = state.hand[h].realPosition;
    set.direction.clear();
    set.free.clear();
    set.compliance.clear();
    set.key.clear();
    set.lambda.clear();
    for (std::size_t i = 0; i < n; ++i) {
      if (rows[i].hand != h) continue;
      double free = rows[i].freeFull;
      for (std::size_t j = 0; j < n; ++j) {
        if (rows[j].hand != h) {
          free += compliance[i * n + j] * lambda[j];
        } else {
          set.compliance.push_back(compliance[i * n + j]);
        }
      }
      set.direction.push_back(rows[i].direction);
      set.free.push_back(free);
      set.key.push_back(rows[i].contact.key);
      set.lambda.push_back(lambda[i]);
    }
  }
}

}  // namespace calot
