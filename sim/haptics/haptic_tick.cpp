// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/haptics/haptic_tick.h"

#include <algorithm>
#include <cmath>

#include "sim/math/floating_point.h"
#include "sim/scene/description.h"

namespace calot {

Vec3 portForce(const PortModel& model, const Vec3& tip, double& seal) {
  Vec3 force = Vec3::Zero();
  if (!model.felt()) return force;
  const Vec3 reach = tip - model.port;
  const double length = reach.norm();
  const Vec3 axis = reach / length;
  if (model.trocarFriction > 0.0) {
    if (seal < 0.0) seal = length;
    const double maxStretch = model.trocarFriction / model.sealStiffness;
    const double stretch = std::clamp(length - seal, -maxStretch, maxStretch);
    seal = length - stretch;
    force -= (model.sealStiffness * stretch) * axis;
  }
  if (model.wallStiffness > 0.0) {
    const Vec3 across = model.neutralAxis - axis * axis.dot(model.neutralAxis);
    force += (model.wallStiffness / length) * across;
  }
  return force;
}

namespace {

constexpr double residualDecay = 0.9;  ///< factor per tick of the difference between contact sets
constexpr double tickSeconds = 0.001;

bool finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

bool isConsistent(const ContactSet& set) {
  std::size_t rows = 0;
  for (const BlockKind kind : set.kind) {
    if (kind > BlockKind::bilateral) return false;
    rows += blockRows(kind);
  }
  if (set.limit.size() != set.kind.size() || set.direction.size() != rows || set.free.size() != rows ||
      set.rate.size() != rows || set.lambda.size() != rows || set.compliance.size() != rows * rows) {
    return false;
  }
  for (const ToolRow& row : set.direction) {
    if (!row.allFinite()) return false;
  }
  for (std::size_t i = 0; i < rows; ++i) {
    if (!(set.compliance[i * rows + i] > 0.0)) return false;
  }
  return finite(set.limit) && finite(set.free) && finite(set.rate) && finite(set.lambda) && finite(set.compliance) &&
         set.reference.position.allFinite() && set.reference.orientation.coeffs().allFinite();
}

bool isConsistent(const HapticState& state, const ContactSet& set) {
  return state.set != set.step || state.lambda.size() == set.free.size();
}

ToolRow couplingStretch(const Pose& simulated, const Pose& real, double maxStretch) {
  ToolRow q;
  Vec3 way = real.position - simulated.position;
  const double size = way.norm();
  if (size > maxStretch) way *= maxStretch / size;
  q.head<3>() = way;
  q[3] = std::clamp(rollBetween(simulated.orientation, real.orientation), -maxRollStretch, maxRollStretch);
  return q;
}

HapticForce hapticTick(const HapticModel& model, HapticState& state, const ContactSet& set) {
  const FloatingPointScope scope;
  const std::size_t rows = set.free.size();
  const bool changed = state.set != set.step;
  if (changed) {
    state.set = set.step;
    state.age = 0;
    state.lambda.assign(set.lambda.begin(), set.lambda.end());
  }
  const Vec3 axis = state.orientation.toRotationMatrix().col(2);
  ToolRow out = ToolRow::Zero();
  if (rows > 0) {
    // One array, whose capacity is reused, holds forces, free gaps and final gaps.
    state.lambda.resize(3 * rows);
    const std::span<double> all(state.lambda);
    const ToolRow q = couplingStretch(set.reference, {state.tip, state.orientation}, model.maxStretch);
    const double since = tickSeconds * std::min(state.age + 1, model.ticksPerStep);
    for (std::size_t i = 0; i < rows; ++i) all[rows + i] = set.free[i] + since * set.rate[i] + set.direction[i].dot(q);
    sweepContacts({set.kind, set.limit, set.compliance, all.subspan(rows, rows)}, all.first(rows),
                  all.subspan(2 * rows, rows), model.tolerance, model.sweeps);
    for (std::size_t i = 0; i < rows; ++i) out += state.lambda[i] * set.direction[i];
    state.lambda.resize(rows);
  }
  if (state.age < model.ticksPerStep) ++state.age;
  if (changed) {
    state.forceResidual = state.force - out.head<3>();
    state.torqueResidual = state.torque - out[3];
  }
  state.forceResidual *= residualDecay;
  state.torqueResidual *= residualDecay;
  state.force = out.head<3>() + state.forceResidual;
  state.torque = out[3] + state.torqueResidual;
  const double size = state.force.norm();
  if (size > model.maxForce) state.force *= model.maxForce / size;
  if (!model.port.felt()) return {state.force, state.torque * axis};
  Vec3 shown = state.force + portForce(model.port, state.tip, state.seal);
  const double total = shown.norm();
  if (total > model.maxForce) shown *= model.maxForce / total;
  return {shown, state.torque * axis};
}

HapticState initialHaptics(const State& state, std::size_t hand) {
  HapticState haptics;
  haptics.tip = state.hand[hand].input.position;
  haptics.orientation = state.hand[hand].input.orientation;
  return haptics;
}

void takeSample(const Model& model, std::size_t hand, const InstrumentSample& sample, HapticState& haptics) {
  if (!isMeasurement(sample)) return;
  const Pose pose = realPose(model.scene(), hand, sample, haptics.tip);
  haptics.tip = pose.position;
  haptics.orientation = pose.orientation;
}

HapticModel hapticModel(const Model& model, std::size_t hand) {
  const HandDescription& description = model.scene().hands[hand];
  HapticModel haptics;
  haptics.maxForce = description.maxForce;
  haptics.maxStretch = description.maxForce / description.couplingStiffness;
  haptics.ticksPerStep = model.scene().ticksPerStep;
  haptics.port = {description.port, axisOf(description.port, description.home), description.trocarFriction,
                  description.wallStiffness, description.couplingStiffness};
  return haptics;
}

}  // namespace calot
