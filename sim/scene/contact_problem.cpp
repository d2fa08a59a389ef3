// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a step that poses and solves the contact problem.
//
// Organs move freely under the forces of the last step first. What has to change is decided on a cheap compliance (that
// of the rest shape, turned with the nodes), carried out by the step's own matrix in one solve for all forces together,
// and decided again with the gaps that this left, as often as the scene allows. A force that stays as it is costs
// nothing and carries no error of the compliance: at rest the gaps are those of the true equilibrium.
#include <algorithm>
#include <array>

#include "sim/scene/stepper_workspace.h"

namespace calot {

using namespace stepping;

namespace {

/// Relative weight of a skin more compliant than the mesh can show; keeps rows that repeat each other apart.
constexpr double skinShare = 1e-4;
constexpr double largestSurprise = 2.0;  ///< tissue that answers by more than this multiple of what was expected
constexpr double leastShare = 1e-3;      ///< and by less than this share: rounding, not an answer

/// A nodal quantity at a place.
Vec3 at(const SolidSolver::Impulse& place, std::span<const Vec3> values) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < place.count; ++k)
    sum += place.weight[k] * values[static_cast<std::size_t>(place.node[k])];
  return sum;
}

}  // namespace

/// Numbers the rows and looks up the forces that the last step left at the same places.
void Stepper::Workspace::recallForces(const State& state) {
  std::erase_if(blocks, [&](const ContactBlock& block) {
    return !moved[block.body] && (block.other == ContactBlock::nobody || !moved[block.other]);
  });
  rows = 0;
  kinds.clear();
  limits.clear();
  carried.clear();
  for (ContactBlock& block : blocks) {
    block.row = rows;
    rows += block.rows();
    kinds.push_back(block.kind);
    limits.push_back(block.limit);
    Vec3 force = Vec3::Zero();
    if (block.hand == ContactBlock::nobody) {
      const std::vector<std::uint64_t>& keys = state.tissue.key;
      const auto found_ = std::lower_bound(keys.begin(), keys.end(), block.key);
      if (found_ != keys.end() && *found_ == block.key) {
        force = state.tissue.force[static_cast<std::size_t>(found_ - keys.begin())] * block.direction[0];
      }
    } else if (block.anchor != ContactBlock::nobody) {
      force = state.hand[block.hand].graspForce[block.anchor];
    } else {
      const HandState& hand = state.hand[block.hand];
      for (std::size_t k = 0; k < hand.contactKey.size(); ++k) {
        if (hand.contactKey[k] == block.key) force = hand.contactForce[k];
      }
    }
    for (std::size_t k = 0; k < block.rows(); ++k) carried.push_back(force.dot(block.direction[k]));
    makeAdmissible(block.kind, block.limit, std::span(carried).subspan(block.row, block.rows()));
  }
  lambda = carried;
}

/// Gaps that the organs' present velocities lead to, instruments at their real places and pushed by `lambda`.
void Stepper::Workspace::measureGaps() {
  const double h = settings.step;
  trueGap.resize(rows);
  for (const ContactBlock& block : blocks) {
    Vec3 apart = Vec3::Zero();
    if (moved[block.body]) apart -= h * at(block.place, body[block.body]->freeVelocity());
    if (block.other != ContactBlock::nobody && moved[block.other]) {
      apart += h * at(block.otherPlace, body[block.other]->freeVelocity());
    }
    ToolRow q = ToolRow::Zero();
    if (block.hand != ContactBlock::nobody) {
      const HandDescription& hand = model.scene().hands[block.hand];
      q = stretch[block.hand];
      for (const ContactBlock& b : blocks) {
        if (b.hand != block.hand) continue;
        for (std::size_t k = 0; k < b.rows(); ++k) {
          q.head<3>() += lambda[b.row + k] / hand.couplingStiffness * b.tool[k].head<3>();
          q[3] += lambda[b.row + k] / hand.rollStiffness * b.tool[k][3];
        }
      }
    }
    for (std::size_t k = 0; k < block.rows(); ++k) {
      trueGap[block.row + k] = block.gap[k] + block.direction[k].dot(apart) + block.tool[k].dot(q);
    }
    if (block.hand == ContactBlock::nobody) trueGap[block.row] += tissueSoftness * lambda[block.row];
  }
}

/// Drops what stays open, and sets up the compliance of the rest.
void Stepper::Workspace::poseProblem(const State& state) {
  measureGaps();
  std::size_t kept = 0;
  result.contact.violation = 0.0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    ContactBlock& block = blocks[b];
    const double* g = trueGap.data() + block.row;
    const double violation = block.kind == BlockKind::ball ? Vec3(g[0], g[1], g[2]).norm() : std::max(0.0, -g[0]);
    result.contact.violation = std::max(result.contact.violation, violation);
    if (block.kind != BlockKind::ball && g[0] > slack && carried[block.row] == 0.0) continue;
    if (kept != b) blocks[kept] = block;
    ++kept;
  }
  blocks.resize(kept);
  std::size_t to = 0;
  kinds.clear();
  limits.clear();
  for (ContactBlock& block : blocks) {
    for (std::size_t k = 0; k < block.rows(); ++k) {
      carried[to + k] = carried[block.row + k];
      trueGap[to + k] = trueGap[block.row + k];
    }
    kinds.push_back(block.kind);
    limits.push_back(block.limit);
    block.row = to;
    to += block.rows();
  }
  rows = to;
  carried.resize(rows);
  trueGap.resize(rows);
  lambda = carried;
  assembleCompliance(state);
}

/// Compliance of the rest shapes, turned with the nodes, and that of the virtual couplings.
void Stepper::Workspace::assembleCompliance(const State& state) {
  const double h2 = settings.step * settings.step;
  /// One body's part of a block: its nodes with weight and rotation, and the sign with which it opens the gap.
  struct Part {
    std::size_t block, body;
    double sign;
    const SolidSolver::Impulse* place;
    std::size_t turns;                            // of its nodes: weight times rotation
    std::size_t coupling = ContactBlock::nobody;  // that the body takes part in
    std::vector<Mat3> ties;                       // relative velocities there
    std::vector<Mat3> pulls;                      // with which they answer
    [[nodiscard]] std::span<const int> nodes() const { return {place->node.data(), place->count}; }
  };
  std::vector<Part> parts;
  std::array<Mat3, SolidSolver::Impulse::mostNodes> turn;
  turns.clear();
  std::vector<bool> stiffened(coupling.size(), false);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const auto add = [&](std::size_t which, const SolidSolver::Impulse& place, double sign) {
      if (which == ContactBlock::nobody || !moved[which]) return;
      parts.push_back({b, which, sign, &place, turns.size(), ContactBlock::nobody, {}, {}});
      body[which]->require({place.node.data(), place.count});
      for (std::size_t k = 0; k < place.count; ++k) {
        turn[k] = place.weight[k] * body[which]->turn(state, place.node[k]);
        turns.push_back(columnsOf(turn[k]));
      }
      for (std::size_t c = 0; c < coupling.size(); ++c) {
        if (!coupling[c].joins(which)) continue;
        if (!stiffened[c]) coupling[c].stiffen(state, body);
        stiffened[c] = true;
        parts.back().coupling = c;
        coupling[c].answers(*body[which], which, place, turn, parts.back().ties);
        coupling[c].pulls(parts.back().ties, parts.back().pulls);
        break;
      }
    };
    add(blocks[b].body, blocks[b].place, -1.0);
    add(blocks[b].other, blocks[b].otherPlace, 1.0);
  }
  tissueCompliance.assign(rows * rows, 0.0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (std::size_t q = p; q < parts.size(); ++q) {
      const Part& a = parts[p];
      const Part& b = parts[q];
      const bool coupled = a.coupling != ContactBlock::nobody && a.coupling == b.coupling;
      if (a.body != b.body && !coupled) continue;
      Mat3 c = Mat3::Zero();
      if (a.body == b.body) {
        nodeBlocks.resize(9 * a.place->count * b.place->count + 1);
        body[a.body]->blocks(a.nodes(), b.nodes(), nodeBlocks);
        c = sumOfTurned({turns.data() + a.turns, a.place->count}, nodeBlocks, {turns.data() + b.turns, b.place->count});
      }
      if (coupled) c -= coupling[a.coupling].taken(a.ties, b.pulls);
      c *= h2 * a.sign * b.sign;
      const ContactBlock& one = blocks[a.block];
      const ContactBlock& two = blocks[b.block];
      for (std::size_t i = 0; i < one.rows(); ++i) {
        for (std::size_t j = 0; j < two.rows(); ++j) {
          const double w = one.direction[i].dot(c * two.direction[j]);
          tissueCompliance[(one.row + i) * rows + two.row + j] += w;
          if (p != q) tissueCompliance[(two.row + j) * rows + one.row + i] += w;
        }
      }
    }
  }
  // C_ab and C_ba come from different solves, each to its tolerance.
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = i + 1; j < rows; ++j) {
      const double mean = 0.5 * (tissueCompliance[i * rows + j] + tissueCompliance[j * rows + i]);
      tissueCompliance[i * rows + j] = tissueCompliance[j * rows + i] = mean;
    }
  }
  couplingCompliance.assign(rows * rows, 0.0);
  for (const ContactBlock& a : blocks) {
    if (a.hand == ContactBlock::nobody) couplingCompliance[a.row * rows + a.row] = tissueSoftness;
    for (const ContactBlock& b : blocks) {
      if (a.hand == ContactBlock::nobody || a.hand != b.hand) continue;
      const HandDescription& hand = model.scene().hands[a.hand];
      for (std::size_t i = 0; i < a.rows(); ++i) {
        for (std::size_t j = 0; j < b.rows(); ++j) {
          couplingCompliance[(a.row + i) * rows + b.row + j] +=
              a.tool[i].head<3>().dot(b.tool[j].head<3>()) / hand.couplingStiffness +
              a.tool[i][3] * b.tool[j][3] / hand.rollStiffness;
        }
      }
    }
  }
  addCompliances();
}

/// What the problem is decided on: tissue and virtual couplings.
void Stepper::Workspace::addCompliances() {
  compliance.resize(rows * rows);
  for (std::size_t i = 0; i < rows * rows; ++i) compliance[i] = tissueCompliance[i] + couplingCompliance[i];
  for (std::size_t i = 0; i < rows; ++i) compliance[i * rows + i] *= 1.0 + skinShare;
}

/// Carries out a change of forces, as far as the tissue bears it, and learns from the answer how compliant it is.
///
/// The compliance W that forces are decided on is that of the rest shape, without what ties organs to one another.
/// Where the answer y to the change s is W s, nothing happens. Where it is more than twice as large, going on like that
/// would lead away from the solution: the change is taken back to the share for which y is as large as it was expected
/// to be. Then W is corrected so that it gives this answer (BFGS; Nocedal and Wright 2006, 6.19):
///   W += y y^T / (y.s) - W s s^T W / (s.W s),
/// which leaves it symmetric and positive.
void Stepper::Workspace::followChange() {
  gapBefore = trueGap;
  const auto answer = [&] {
    measureGaps();
    expected.assign(rows, 0.0);
    double softness = 0.0;
    double wanted = 0.0;
    for (std::size_t i = 0; i < rows; ++i) {
      double coupled = 0.0;
      for (std::size_t j = 0; j < rows; ++j) {
        expected[i] += tissueCompliance[i * rows + j] * change[j];
        coupled += couplingCompliance[i * rows + j] * change[j];
      }
      answered[i] = trueGap[i] - gapBefore[i] - coupled;
      softness += change[i] * answered[i];
      wanted += change[i] * expected[i];
    }
    return std::array{softness, wanted};
  };
  answered.resize(rows);
  for (std::size_t i = 0; i < rows; ++i) change[i] = lambda[i] - carried[i];
  carryOut(change);
  auto [softness, wanted] = answer();
  if (wanted > 0.0 && softness > largestSurprise * wanted) {
    const double back = wanted / softness - 1.0;
    for (std::size_t i = 0; i < rows; ++i) change[i] *= back;
    carryOut(change);
    for (std::size_t i = 0; i < rows; ++i) {
      change[i] *= (1.0 + back) / back;
      lambda[i] = carried[i] + change[i];
    }
    const auto again = answer();
    softness = again[0];
    wanted = again[1];
  }
  carried = lambda;
  if (!(wanted > 0.0) || !(softness > leastShare * wanted)) return;
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < rows; ++j) {
      tissueCompliance[i * rows + j] += answered[i] * answered[j] / softness - expected[i] * expected[j] / wanted;
    }
  }
  addCompliances();
}

void Stepper::Workspace::solveContacts() {
  const SolverDescription& limitsOf = model.scene().solver;
  ContactResult& out = result.contact;
  out.blocks = static_cast<std::uint32_t>(blocks.size());
  out.rows = static_cast<std::uint32_t>(rows);
  freeGap.resize(rows);
  gap.resize(rows);
  change.resize(rows);
  const ContactProblem problem{kinds, limits, compliance, freeGap};
  // Free gaps that give back the true ones under the present forces.
  const auto takeGaps = [&] {
    std::fill(freeGap.begin(), freeGap.end(), 0.0);
    evaluateGaps(problem, lambda, gap);
    for (std::size_t i = 0; i < rows; ++i) freeGap[i] = trueGap[i] - gap[i];
  };
  for (out.passes = 0; rows > 0;) {
    takeGaps();
    out.error = naturalResidual(problem, lambda, trueGap);
    if (out.passes == limitsOf.contactPasses || (out.passes > 0 && out.error <= limitsOf.contactTolerance)) break;
    const ContactReport report =
        contactSolver.solve(problem, lambda, gap, limitsOf.contactTolerance, limitsOf.contactIterations);
    ++out.passes;
    out.iterations += report.sweeps;
    out.newtonSteps += report.newtonSteps;
    out.residual = report.residual;
    followChange();
  }
  if (out.residual > limitsOf.contactTolerance) {
    result.misses |= miss::contact;
    emit(EventKind::contactMiss, 255, 0, Vec3::Zero(), out.residual);
  }
}

/// Stores the forces for the next step.
void Stepper::Workspace::keepForces(State& state) {
  for (HandState& hand : state.hand) {
    hand.contactKey.clear();
    hand.contactForce.clear();
  }
  state.tissue.key.clear();
  state.tissue.force.clear();
  for (const ContactBlock& block : blocks) {
    Vec3 force = Vec3::Zero();
    for (std::size_t k = 0; k < block.rows(); ++k) force += lambda[block.row + k] * block.direction[k];
    if (block.hand == ContactBlock::nobody) {
      state.tissue.key.push_back(block.key);
      state.tissue.force.push_back(lambda[block.row]);
    } else if (block.anchor != ContactBlock::nobody) {
      state.hand[block.hand].graspForce[block.anchor] = force;
    } else {
      state.hand[block.hand].contactKey.push_back(block.key);
      state.hand[block.hand].contactForce.push_back(force);
    }
  }
}

}  // namespace calot
