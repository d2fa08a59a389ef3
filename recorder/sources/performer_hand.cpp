// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "recorder/sources/operation_mind.h"

#include <algorithm>
#include <cmath>

#include "recorder/sources/pointing.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr double fadeIn = 0.5;       // unsteadiness grows from nothing: the tip starts at home (s)
constexpr double wanderLower = 0.1;  // Hz
constexpr double wanderUpper = 0.8;
constexpr double ramp = 0.15;        // share of a steady stroke in which its speed rises, and falls
constexpr double steadyShare = 0.5;  // of the shortest stroke: pieces of one stroke through tissue may be shorter
constexpr double pi = 3.141592653589793;

Random unsteady(std::uint64_t seed, std::size_t index) { return Random(seed, 101 + index); }

}  // namespace

PerformerHand::PerformerHand(const PerformerProfile& profile, const HandDescription& hand, std::size_t index,
                             std::uint64_t seed)
    : profile_(profile), hand_(hand), random_(seed, 11 + index), instrument_(hand.instrument) {
  Random random = unsteady(seed, index);
  const PerformerProfile::Motor& motor = profile.motor;
  tremor_ = Unsteadiness(motor.tremorAmplitude, motor.tremorLower, motor.tremorUpper, random);
  wander_ = Unsteadiness(motor.wanderAmplitude, wanderLower, wanderUpper, random);
  stroke_.from = stroke_.to = hand.home;
}

void PerformerHand::add(const HandMove& move) { queue_.push_back(move); }

void PerformerHand::clear() { queue_.clear(); }

Vec3 PerformerHand::shaft(const Vec3& p) const { return shaftDirection(hand_.port, p); }

double PerformerHand::rollFor(const HandMove& move) const {
  if (move.aiming == HandMove::Aim::none) return stroke_.rollTo;
  const Mat3 level = pointing(hand_.port, move.to).toRotationMatrix();
  const double across = move.aim.dot(level.col(0));
  const double up = move.aim.dot(level.col(1));
  if (across * across + up * up < 1e-6) return stroke_.rollTo;
  const bool hinge = move.aiming == HandMove::Aim::hinge;
  // At roll r the hinge is cos r x + sin r y, the toe -sin r x + cos r y.
  double roll = hinge ? arctangent2(up, across) : arctangent2(-across, up);
  const double turn = hinge ? pi : 2.0 * pi;
  while (roll - stroke_.rollTo > 0.5 * turn) roll -= turn;
  while (roll - stroke_.rollTo < -0.5 * turn) roll += turn;
  return roll;
}

void PerformerHand::begin(double time) {
  const HandMove move = queue_.front();
  queue_.pop_front();
  const PerformerProfile::Motor& motor = profile_.motor;
  Running next;
  next.start = time;
  next.from = stroke_.to;
  next.to = move.to;
  const double length = (move.to - stroke_.to).norm();
  if (!move.sure) {
    const double noise = motor.endpointNoise * length;
    double along = 0.0;
    if (random_.uniform() < motor.overshootShare) along = motor.overshoot;
    next.to += along * (move.to - stroke_.to);
    for (int a = 0; a < 3; ++a) next.to[a] += noise * random_.normal();
  }
  const bool still = length < 1e-9 && move.aiming == HandMove::Aim::none && move.jaw == stroke_.jawTo;
  const double shortest = (move.steady ? steadyShare : 1.0) * motor.minStroke;
  next.duration = still ? 0.0 : std::max(length / move.speed, shortest);
  next.jawFrom = stroke_.jawTo;
  next.jawTo = move.jaw;
  next.rollFrom = stroke_.rollTo;
  next.rollTo = rollFor(move);
  next.buttons = move.buttons;
  next.steady = move.steady;
  if (move.instrument != InstrumentKind::none) instrument_ = move.instrument;
  stroke_ = next;
  end_ = time + next.duration + move.dwell;
}

double PerformerHand::progress(double time) const {
  if (!(stroke_.duration > 0.0)) return 1.0;
  const double u = std::min(notNegative((time - stroke_.start) / stroke_.duration), 1.0);
  if (!stroke_.steady) return minimumJerk(u);
  // Speed rises evenly, stays, falls evenly.
  const double speed = 1.0 / (1.0 - ramp);
  if (u < ramp) return 0.5 * speed * u * u / ramp;
  if (u > 1.0 - ramp) return 1.0 - 0.5 * speed * (1.0 - u) * (1.0 - u) / ramp;
  return speed * (u - 0.5 * ramp);
}

InstrumentSample PerformerHand::sample(double time) {
  while (time >= end_ && !queue_.empty()) begin(time);
  const double s = progress(time);
  const double fade = minimumJerk(time / fadeIn);
  InstrumentSample sample;
  sample.instrument = instrument_;
  sample.position = stroke_.from + s * (stroke_.to - stroke_.from) + fade * (tremor_.at(time) + wander_.at(time));
  sample.orientation =
      pointing(hand_.port, sample.position, stroke_.rollFrom + s * (stroke_.rollTo - stroke_.rollFrom));
  sample.jaw = stroke_.jawFrom + s * (stroke_.jawTo - stroke_.jawFrom);
  sample.buttons = time < end_ ? stroke_.buttons : static_cast<std::uint8_t>(stroke_.buttons & button::lock);
  return sample;
}

}  // namespace calot::recorder
