// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/beam_solver.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sim/vessel/beam_model.h"
#include "sim/vessel/beam_state.h"

namespace calot {

namespace {

/// Greatest relative motion of a chord's ends per step, as a share of its rest length, and rotation of a node (rad).
constexpr double maxRotation = 0.7;
/// Greatest speed of a node (m/s). No hand moves tissue as fast; the limit prevents overflow in loose pieces.
constexpr double fastest = 10.0;

/// Adds scale * m to the 3 x 3 part of a block at (row, column) in {0, 3}.
void add(Block6& block, std::size_t row, std::size_t column, double scale, const Mat3& m) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      block[6 * (row + i) + column + j] += scale * m(static_cast<int>(i), static_cast<int>(j));
    }
  }
}

void add(Vector6& v, std::size_t at, double scale, const Vec3& x) {
  for (std::size_t i = 0; i < 3; ++i) v[at + i] += scale * x[static_cast<int>(i)];
}

}  // namespace

void BeamSolver::assembleNodes(const BeamModel& model, const BeamState& state, const BeamLoads& loads) {
  const double h = step_;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    Block6& block = tree_.diagonal(n);
    Vector6& right = right_[n];
    right.fill(0.0);
    const double mass = model.mass()[n];
    const double inertia = model.inertia()[n];
    const double alpha = model.massDamping()[n];
    for (std::size_t i = 0; i < 3; ++i) {
      block[7 * i] = (1.0 + alpha * h) * mass;
      block[7 * (i + 3)] = (1.0 + alpha * h) * inertia;
    }
    add(right, 0, h * mass, loads.gravity - alpha * state.velocity[n]);
    add(right, 3, -h * inertia * alpha, state.angularVelocity[n]);
    if (!loads.force.empty()) add(right, 0, h, loads.force[n]);
    if (!loads.torque.empty()) add(right, 3, h, loads.torque[n]);
  }
  for (const BeamAttachment& a : loads.attachments) {
    const auto n = static_cast<std::size_t>(a.node);
    Block6& block = tree_.diagonal(n);
    for (std::size_t i = 0; i < 3; ++i) block[7 * i] += h * h * a.stiffness + h * a.damping;
    const Vec3 relative = a.velocity - state.velocity[n];
    add(right_[n], 0, h, a.stiffness * (a.target - state.position[n] + h * relative) + a.damping * relative);
  }
}

void BeamSolver::assembleElement(const BeamModel& model, const BeamState& state, std::size_t index) {
  const double h = step_;
  const BeamElement& e = model.elements()[index];
  const auto a = static_cast<std::size_t>(e.a);
  const auto b = static_cast<std::size_t>(e.b);
  const BeamStrain s = strainOf(e, state, index);
  const BeamStiffness k = stiffnessOf(e, s, state.sleeve[index]);

  // Forces at x and their change by the velocities.
  const Vec3 apart = state.velocity[b] - state.velocity[a];
  const Vec3& wa = state.angularVelocity[a];
  const Vec3& wb = state.angularVelocity[b];
  const double ahead = h + e.damping;
  const Vec3 viscous = (ahead * k.stretch) * (apart + k.ga * wa + k.gb * wb);
  const Vec3 force = s.force + viscous;
  const Vec3 full = force + (h * k.string) * (k.across * apart);
  const Vec3 moment = s.moment + ahead * (k.bend * (wb - wa));
  add(right_[a], 0, h, full);
  add(right_[b], 0, -h, full);
  add(right_[a], 3, h, moment - k.ga.transpose() * force);
  add(right_[b], 3, -h, moment + k.gb.transpose() * force);

  const double c = h * ahead * k.stretch;
  const double bend = h * ahead;
  Mat3 xx = (h * h * k.string) * k.across;
  for (int i = 0; i < 3; ++i) xx(i, i) += c;
  Block6& da = tree_.diagonal(a);
  Block6& db = tree_.diagonal(b);
  Block6& ba = tree_.coupling(b);  // row b, column a
  const Mat3 gat = k.ga.transpose();
  const Mat3 gbt = k.gb.transpose();
  const Mat3 gaa = gat * k.ga;
  const Mat3 gbb = gbt * k.gb;
  const Mat3 gba = gbt * k.ga;
  add(da, 0, 0, 1.0, xx);
  add(da, 0, 3, -c, k.ga);
  add(da, 3, 0, -c, gat);
  add(da, 3, 3, c, gaa);
  add(da, 3, 3, bend, k.bend);
  add(db, 0, 0, 1.0, xx);
  add(db, 0, 3, c, k.gb);
  add(db, 3, 0, c, gbt);
  add(db, 3, 3, c, gbb);
  add(db, 3, 3, bend, k.bend);
  add(ba, 0, 0, -1.0, xx);
  add(ba, 0, 3, c, k.ga);
  add(ba, 3, 0, -c, gbt);
  add(ba, 3, 3, c, gba);
  add(ba, 3, 3, -bend, k.bend);
}

bool BeamSolver::solveUnconstrained(const BeamModel& model, const BeamState& state, const BeamLoads& loads,
                                    double step) {
  step_ = step;
  const std::size_t nodes = model.nodes();
  tree_.reset(nodes);
  right_.resize(nodes);
  columnOf_.assign(nodes, -1);
  columns_ = 0;
  assembleNodes(model, state, loads);
  for (std::size_t e = 0; e < model.elements().size(); ++e) {
    if (state.parting[e] == Parting::none) assembleElement(model, state, e);
  }
  // Constrained nodes: identity rows without couplings, zero right-hand side.
  for (std::size_t n = 0; n < nodes; ++n) {
    const int p = model.parents()[n];
    if (model.fixed(n) || (p >= 0 && model.fixed(static_cast<std::size_t>(p)))) tree_.coupling(n).fill(0.0);
    if (!model.fixed(n)) continue;
    Block6& block = tree_.diagonal(n);
    block.fill(0.0);
    for (std::size_t i = 0; i < 6; ++i) block[7 * i] = 1.0;
    right_[n].fill(0.0);
  }
  const bool positive = tree_.factor(model.parents());
  freeVelocity_.assign(state.velocity.begin(), state.velocity.end());
  freeAngularVelocity_.assign(state.angularVelocity.begin(), state.angularVelocity.end());
  solveInto(model);
  return positive;
}

void BeamSolver::solveInto(const BeamModel& model) {
  tree_.solve(model.parents(), right_);
  for (std::size_t n = 0; n < right_.size(); ++n) {
    freeVelocity_[n] += Vec3(right_[n][0], right_[n][1], right_[n][2]);
    freeAngularVelocity_[n] += Vec3(right_[n][3], right_[n][4], right_[n][5]);
  }
}

void BeamSolver::applyImpulses(const BeamModel& model, std::span<const Vec3> impulse) {
  assert(impulse.size() == right_.size());
  for (std::size_t n = 0; n < right_.size(); ++n) {
    right_[n].fill(0.0);
    if (!model.fixed(n)) add(right_[n], 0, 1.0, impulse[n]);
  }
  solveInto(model);
}

void BeamSolver::precomputeCompliance(const BeamModel& model, std::span<const int> nodes) {
  const std::size_t size = 9 * model.nodes();
  for (const int node : nodes) {
    const auto n = static_cast<std::size_t>(node);
    if (columnOf_[n] >= 0) continue;
    columnOf_[n] = static_cast<int>(columns_);
    ++columns_;
    if (column_.size() < columns_ * size) column_.resize(columns_ * size);
    const std::span<double> out = std::span(column_).subspan((columns_ - 1) * size, size);
    if (model.fixed(n)) {
      std::fill(out.begin(), out.end(), 0.0);
    } else {
      tree_.columns(model.parents(), n, out);
    }
  }
}

Mat3 BeamSolver::block(int a, int b) const {
  assert(columnOf_[static_cast<std::size_t>(b)] >= 0);
  const std::size_t size = 9 * right_.size();
  const double* c = column_.data() + static_cast<std::size_t>(columnOf_[static_cast<std::size_t>(b)]) * size +
                    9 * static_cast<std::size_t>(a);
  Mat3 m;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) m(i, k) = c[3 * i + k];
  }
  return m;
}

/// A linear step cannot follow a chord whose ends move by about its own length relative to each other. All
/// velocities of such a piece are scaled down together, which preserves the pattern of motion. advance() handles
/// pieces that are not finite.
bool BeamSolver::limitPieces(const BeamModel& model, const BeamState& state) {
  const std::size_t nodes = model.nodes();
  piece_.resize(nodes);
  excess_.assign(nodes, 1.0);
  for (std::size_t n = 0; n < nodes; ++n) {
    const int before = model.elementBefore(n);
    const bool joined = before >= 0 && state.parting[static_cast<std::size_t>(before)] == Parting::none;
    piece_[n] = joined ? piece_[static_cast<std::size_t>(model.parents()[n])] : static_cast<int>(n);
    double& excess = excess_[static_cast<std::size_t>(piece_[n])];
    excess =
        std::max({excess, step_ * freeAngularVelocity_[n].norm() / maxRotation, freeVelocity_[n].norm() / fastest});
    if (!joined) continue;
    const BeamElement& e = model.elements()[static_cast<std::size_t>(before)];
    const Vec3 apart = freeVelocity_[n] - freeVelocity_[static_cast<std::size_t>(e.a)];
    excess = std::max(excess, step_ * apart.norm() / (maxRotation * e.length));
  }
  bool limited = false;
  for (std::size_t n = 0; n < nodes; ++n) {
    const double excess = excess_[static_cast<std::size_t>(piece_[n])];
    if (!(excess > 1.0) || model.fixed(n)) continue;
    limited = true;
    freeVelocity_[n] /= excess;
    freeAngularVelocity_[n] /= excess;
  }
  return limited;
}

BeamReport BeamSolver::advance(const BeamModel& model, BeamState& state) {
  BeamReport report;
  double asked = 0.0;
  for (const Vec3& v : freeVelocity_) asked = std::max(asked, v.squaredNorm());
  if (asked > fastest * fastest) report.requestedSpeed = std::sqrt(asked);
  report.limited = limitPieces(model, state);
  double displacement = 0.0;
  double speed = 0.0;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    const Vec3 position = state.position[n] + step_ * freeVelocity_[n];
    const Quat orientation = rotated(state.orientation[n], step_ * freeAngularVelocity_[n]);
    if (position.allFinite() && freeVelocity_[n].allFinite() && freeAngularVelocity_[n].allFinite() &&
        orientation.coeffs().allFinite() && orientation.coeffs().squaredNorm() > 0.5) {
      state.position[n] = position;
      state.orientation[n] = orientation;
      state.velocity[n] = freeVelocity_[n];
      state.angularVelocity[n] = freeAngularVelocity_[n];
    } else {
      report.finite = false;
      state.velocity[n].setZero();
      state.angularVelocity[n].setZero();
    }
    speed = std::max(speed, state.velocity[n].squaredNorm());
    displacement = std::max(displacement, (state.position[n] - model.rest()[n]).squaredNorm());
  }
  report.maxSpeed = std::sqrt(speed);
  state.maxDisplacement = std::sqrt(displacement);

  const std::size_t elements = model.elements().size();
  tension_.resize(elements);
  strain_.resize(elements);
  double excess = 1.0;
  for (std::size_t e = 0; e < elements; ++e) {
    tension_[e] = 0.0;
    strain_[e] = 0.0;
    if (state.parting[e] != Parting::none) continue;
    const BeamElement& element = model.elements()[e];
    const BeamStrain s = strainOf(element, state, e);
    tension_[e] = s.tension;
    strain_[e] = s.stretch;
    state.peakStrain[e] = std::max(state.peakStrain[e], s.stretch);
    if (s.stretch > report.maxStrain) {
      report.maxStrain = s.stretch;
      report.maxStrainElement = static_cast<int>(e);
    }
    if (s.tension > report.maxTension) {
      report.maxTension = s.tension;
      report.maxTensionElement = static_cast<int>(e);
    }
    const double share = s.stretch / model.branches()[static_cast<std::size_t>(element.branch)].material.ultimateStrain;
    if (share > excess) {
      excess = share;
      report.torn = static_cast<int>(e);
    }
  }
  if (report.torn >= 0) {
    state.parting[static_cast<std::size_t>(report.torn)] = Parting::torn;
    state.partedAt[static_cast<std::size_t>(report.torn)] = 0.5;
  }
  return report;
}

}  // namespace calot
