// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a step that carries out what contact decided: correction of organs and instruments, and the problem that
// is published for the haptic ticks.
#include <algorithm>
#include <cmath>

#include "sim/scene/stepper_workspace.h"

namespace calot {

using namespace stepping;

namespace {

constexpr int largestWithdrawals = 6;       ///< passes of withdraw()
constexpr double wantedDepth = 2e-5;        ///< m; deeper is worth another pass
constexpr double largestWithdrawal = 0.02;  ///< of a tip, by all passes of one step (m): the first may lead astray
constexpr std::array<double, 3> retreats{0.005, 0.01, 0.02};  ///< along the shaft, where the nearest way out fails (m)

}  // namespace

/// Adds what forces do to a body's nodes; leaves `nodal_` empty where that is nothing.
void Stepper::Workspace::addForces(std::size_t which, std::span<const double> forces, double scale,
                                   std::vector<Vec3>& nodal_) const {
  for (const ContactBlock& block : blocks) {
    for (const bool other : {false, true}) {
      if ((other ? block.other : block.body) != which) continue;
      Vec3 force = Vec3::Zero();
      for (std::size_t k = 0; k < block.rows(); ++k) force += forces[block.row + k] * block.direction[k];
      if (force.isZero(0.0)) continue;
      if (nodal_.empty()) nodal_.assign(body[which]->nodes(), Vec3::Zero());
      const SolidSolver::Impulse& place = other ? block.otherPlace : block.place;
      const double sign = other ? scale : -scale;
      for (std::size_t k = 0; k < place.count; ++k) {
        nodal_[static_cast<std::size_t>(place.node[k])] += sign * place.weight[k] * force;
      }
    }
  }
}

/// Lets the bodies follow a change of forces, all rows at once: vessels, then organs with what is grown to them, then
/// fat.
void Stepper::Workspace::carryOut(std::span<const double> change_) {
  const std::size_t organs = model.organs().size();
  for (std::size_t k = 0; k < body.size(); ++k) {
    const std::size_t vessels = firstFat() - organs;
    const std::size_t o = k < vessels ? organs + k : k < firstFat() ? k - vessels : k;
    if (!moved[o]) continue;
    nodal[o].clear();
    addForces(o, change_, settings.step, nodal[o]);
    for (TieCoupling& c : coupling) {
      if (c.organ() == o) c.passOn(body, nodal[o]);
    }
    if (nodal[o].empty()) continue;
    const SolveReport report = body[o]->push(nodal[o]);
    for (TieCoupling& c : coupling) {
      if (c.organ() == o) c.pull(body);
    }
    if (!report.converged && (result.misses & miss::solver) == 0) {
      result.misses |= miss::solver;
      emit(EventKind::solverMiss, 255, static_cast<std::uint16_t>(firstStructure(o)), Vec3::Zero(), report.residual);
    }
  }
}

/// Bodies and instruments go where the step leads them.
void Stepper::Workspace::move(State& state) {
  for (std::size_t o = 0; o < body.size(); ++o) {
    if (!moved[o]) continue;
    stopped[o] = !body[o]->advance(state);
    if (stopped[o]) {
      result.misses |= miss::solver;
      emit(EventKind::solverMiss, 255, static_cast<std::uint16_t>(firstStructure(o)), Vec3::Zero(), 1e300);
    }
    if (const double speed = body[o]->heldBack(); speed > 0.0) {
      result.misses |= miss::speed;
      emit(EventKind::motionHeldBack, 255, static_cast<std::uint16_t>(firstStructure(o)), Vec3::Zero(), speed);
    }
  }
  for (std::size_t s = 0; s < skinOf.size(); ++s) {
    if (moved[model.structures()[s].body]) bounded[s] = false;
  }
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    HandState& s = state.hand[hand];
    const HandDescription& description = model.scene().hands[hand];
    ToolRow push = ToolRow::Zero();
    for (const ContactBlock& block : blocks) {
      if (block.hand != hand) continue;
      for (std::size_t k = 0; k < block.rows(); ++k) push += lambda[block.row + k] * block.tool[k];
    }
    Vec3 way = stretch[hand].head<3>() + push.head<3>() / description.couplingStiffness;
    const double size = way.norm();
    if (size > largestSlide) way *= largestSlide / size;
    const double roll =
        std::clamp(stretch[hand][3] + push[3] / description.rollStiffness, -largestRollStretch, largestRollStretch);
    const Pose pose = movedTool(description.port, simulated(state, hand), way, roll);
    s.simulatedPosition = pose.position;
    s.simulatedOrientation = pose.orientation;
    result.hand[hand].contactForce = push.head<3>();
    result.hand[hand].contactTorque = push[3];
  }
}

/// The deepest an instrument in `shape` stands in any organ, and all places where it does.
/// @pre refreshBounds() since organs moved
double Stepper::Workspace::findInside(const State& state, const HandState& hand, const Vec3& port, const Pose& pose) {
  inside.clear();
  double depth = 0.0;
  for (std::size_t o = 0; o < skinOf.size(); ++o) {
    found.clear();
    for (const Capsule& c : shape) {
      const std::span<const std::uint32_t> near = patchesNear(o, c.p0, c.p1, capsuleSearch(c.radius, 0.0));
      const std::size_t before = found.size();
      capsuleContacts(skinOf[o]->surface(), skin[o], near, c.p0, c.p1, c.radius, 0.0, c.piece, found);
      if (const double allowed = allowance(state, hand, c, o); allowed > 0.0) allow(allowed, 0.0, before);
    }
    for (const SurfaceContact& contact : found) {
      if (!(contact.gap < 0.0)) continue;
      inside.push_back({toolRow(port, pose, contact.onAxis, contact.normal), contact.normal, contact.gap});
      depth = std::max(depth, -contact.gap);
    }
  }
  return depth;
}

/// The shortest motion of the instrument that leaves every place in `inside`: a small complementarity problem without
/// organs. Tip motion costs as its square; a roll as the motion of a point 5 mm from the axis.
ToolRow Stepper::Workspace::wayOut() {
  constexpr double arm2 = 0.005 * 0.005;
  const std::size_t n = inside.size();
  const std::vector<double> none(n, 0.0);
  const std::vector<BlockKind> kind(n, BlockKind::unilateral);
  std::vector<double> w(n * n);
  std::vector<double> free(n);
  std::vector<double> gaps(n);
  std::vector<double> force(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    free[i] = inside[i].gap;
    for (std::size_t j = 0; j < n; ++j) {
      w[i * n + j] = inside[i].row.head<3>().dot(inside[j].row.head<3>()) + inside[i].row[3] * inside[j].row[3] / arm2;
    }
    w[i * n + i] *= 1.01;
  }
  sweepContacts({kind, none, w, free}, force, gaps, 0.1 * wantedDepth, 50);
  ToolRow q = ToolRow::Zero();
  for (std::size_t i = 0; i < n; ++i) q += force[i] * inside[i].row;
  q[3] /= arm2;
  return q;
}

/// Follows wayOut() from a pose, pass by pass. Keeps the best place met: folds and pinches may lead a pass astray.
Stepper::Workspace::Withdrawal Stepper::Workspace::withdrawFrom(const State& state, std::size_t hand, Pose pose) {
  const HandState& s = state.hand[hand];
  const Vec3& port = model.scene().hands[hand].port;
  Withdrawal best{pose, 1e300, false};
  double gone = 0.0;
  for (int pass = 0;; ++pass) {
    shapeAt(state, hand, pose, s.jaw);
    const double depth = findInside(state, s, port, pose);
    if (depth < best.depth) {
      best = {pose, depth, false};
      for (const Inside& a : inside) {
        for (const Inside& b : inside) best.pinched = best.pinched || a.normal.dot(b.normal) < -0.25;
      }
    }
    if (depth <= wantedDepth || pass >= largestWithdrawals || gone >= largestWithdrawal) return best;
    const ToolRow q = wayOut();
    Vec3 way = q.head<3>();
    const double size = way.norm();
    const double most = std::min(largestWithdrawal - gone, 3.0 * depth);
    if (size > most) way *= most / size;
    gone += std::min(size, most);
    pose = movedTool(port, pose, way, std::clamp(q[3], -0.2, 0.2));
  }
}

/// Rows are linear, tissue is not: what an instrument is still inside of after the step, it leaves by the shortest
/// motion of its own. In a fold the nearest surface may lie deeper in: then it goes back along its shaft, the way it
/// came in, and looks again. Where tissue presses from two sides there may be no way out: that depth is told as
/// pinched.
void Stepper::Workspace::withdraw(State& state, std::size_t hand) {
  HandState& s = state.hand[hand];
  if (s.instrument == InstrumentKind::none) return;
  const Vec3& port = model.scene().hands[hand].port;
  const Pose from = simulated(state, hand);
  Withdrawal best = withdrawFrom(state, hand, from);
  for (const double retreat : retreats) {
    if (best.depth <= wantedDepth) break;
    const Vec3 back = from.orientation * Vec3(0.0, 0.0, -retreat);
    const Withdrawal other = withdrawFrom(state, hand, movedTool(port, from, back, 0.0));
    if (other.depth < best.depth) best = other;
  }
  s.simulatedPosition = best.pose.position;
  s.simulatedOrientation = best.pose.orientation;
  double& told = best.pinched ? result.contact.pinchedDepth : result.contact.largestDepth;
  told = std::max(told, best.depth);
}

/// The problem of this step, reduced to each hand, for the ticks to come. The other hand's forces, and those among
/// organs, stay as they are.
void Stepper::Workspace::publish(const State& state) {
  const auto velocityAt = [&](std::size_t which, const SolidSolver::Impulse& place) {
    Vec3 v = Vec3::Zero();
    if (which == ContactBlock::nobody) return v;
    for (std::size_t k = 0; k < place.count; ++k)
      v += place.weight[k] * body[which]->velocity(state)[static_cast<std::size_t>(place.node[k])];
    return v;
  };
  for (std::size_t h = 0; h < handCount; ++h) {
    ContactSet& set = contactSet[h];
    set.step = static_cast<std::int64_t>(result.step);
    set.kind.clear();
    set.limit.clear();
    set.direction.clear();
    set.free.clear();
    set.rate.clear();
    set.compliance.clear();
    set.lambda.clear();
    for (const ContactBlock& block : blocks) {
      if (block.hand != h) continue;
      set.kind.push_back(block.kind);
      set.limit.push_back(block.limit);
      const Vec3 velocity = velocityAt(block.body, block.place);
      for (std::size_t k = 0; k < block.rows(); ++k) {
        const std::size_t i = block.row + k;
        double free = freeGap[i] - block.tool[k].dot(stretch[h]);
        for (const ContactBlock& b : blocks) {
          for (std::size_t j = b.row; j < b.row + b.rows(); ++j) {
            if (b.hand == h) {
              set.compliance.push_back(compliance[i * rows + j]);
            } else {
              free += compliance[i * rows + j] * lambda[j];
            }
          }
        }
        set.direction.push_back(block.tool[k]);
        set.free.push_back(free);
        set.rate.push_back(-block.direction[k].dot(velocity));
        set.lambda.push_back(lambda[i]);
      }
    }
  }
}

}  // namespace calot
