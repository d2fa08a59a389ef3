// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "recorder/sources/operation_mind.h"

#include <algorithm>
#include <cmath>

#include "recorder/sources/pointing.h"
#include "sim/instruments/instruments.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr double gripJaw = 0.8;           // open, as it comes (rad)
constexpr double closedJaw = 0.1;         // rad
constexpr double gripApproach = 0.018;    // m
constexpr double gripDepth = 0.004;       // tips go so far past the surface (m)
constexpr double pullSpeed = 0.020;       // m/s
constexpr double bedPull = 0.045;         // more pull as the bed comes free (m)
constexpr double wholePull = 0.3;         // of that, while vessels hold it
constexpr double pullMore = 0.012;        // at one decision (m)
constexpr double easeOff = 0.006;         // at one decision (m)
constexpr double lastPull = 0.03;         // more, to pull off what is left of the bed at the end (m)
constexpr double stillTaut = 0.7;         // of what is too taut: no more pull
constexpr double tautShare = 0.9;         // of the strands that still hold are no longer than what it goes by
constexpr double vesselStretched = 0.12;  // a vessel looks this much longer than at rest: no more pull
constexpr double vesselTaut = 0.22;       // and so taut that it eases off
constexpr std::size_t chord = 5;          // stations from one place of its course to the next
constexpr double leaving = 0.016;         // from a vessel, with open jaws (m)
constexpr double exchangeTime = 0.5;      // s
constexpr double exchangeRest = 0.3;      // s

/// How much longer than at rest the vessel looks that is stretched most and still whole, by its course.
double stretchOf(const Sight& sight) {
  double most = 0.0;
  for (const SeenVessel& vessel : sight.vessel) {
    if (vessel.partings > 0) continue;
    double length = 0.0;
    std::size_t last = 0;
    for (; last + chord < vessel.centre.size(); last += chord) {
      length += (vessel.centre[last + chord] - vessel.centre[last]).norm();
    }
    if (last > 0) most = std::max(most, length / (PerformerSight::spacing * static_cast<double>(last)) - 1.0);
  }
  return most;
}

}  // namespace

HoldingMind::HoldingMind(const OperationTools& tools, std::size_t hand, std::uint64_t seed)
    : tools_(tools), hand_(hand), random_(seed, 21) {}

/// As the bed is freed it retracts further, unless the remaining attachments look too taut; then it eases off.
double HoldingMind::wantedPull(const Sight& sight, double freed, bool divided) const {
  const PerformerProfile::Operation& operation = tools_.profile.operation;
  const double wanted = (divided ? 2.5 : 1.0) * operation.pull + (divided ? 1.0 : wholePull) * bedPull * freed;
  // The last strands may tear.
  if (divided && freed > 1.0 - operation.pullOff) return std::min(pulled_ + pullMore, wanted + lastPull);
  // A few taut strands at an edge, or near the assistant's retraction, do not stop it from exposing the rest.
  std::vector<double> length;
  for (const SeenStrand& s : sight.strand) {
    if (s.attached) length.push_back((s.end[0] - s.end[1]).norm());
  }
  std::sort(length.begin(), length.end());
  const double vessels = stretchOf(sight);
  if (vessels > vesselTaut) return std::max(pulled_ - easeOff, 0.5 * operation.pull);
  if (vessels > vesselStretched) return std::min(pulled_, wanted);
  const double tautest =
      length.empty() ? 0.0 : length[static_cast<std::size_t>(tautShare * static_cast<double>(length.size() - 1))];
  if (tautest > operation.stretch) return std::max(pulled_ - easeOff, operation.pull);
  if (tautest > stillTaut * operation.stretch) return std::min(pulled_, wanted);
  return std::min(pulled_ + pullMore, wanted);
}

void HoldingMind::decide(const Sight& sight, double freed, bool divided) {
  PerformerHand& hand = tools_.hand[hand_];
  const PerformerProfile& profile = tools_.profile;
  if (!tools_.anatomy.hasSpecimen()) {
    ready_ = true;
    return;
  }
  const Vec3 shaft = hand.shaft(sight.grip);
  const auto move = [&](const Vec3& to, double speed, double jaw, std::uint8_t buttons = 0) {
    HandMove out;
    out.to = to;
    out.speed = speed;
    out.jaw = jaw;
    out.buttons = buttons;
    out.aiming = HandMove::Aim::hinge;
    out.aim = tools_.scene.camera.orientation * Vec3::UnitX();
    return out;
  };
  if (at_ == At::pulling && !sight.hand[hand_].holds) {
    ready_ = false;
    at_ = At::away;
    hand.add(move(hand.meant() - gripApproach * shaft, profile.motor.contactSpeed, gripJaw));
  }
  if (at_ == At::pulling && ready_ && random_.uniform() < profile.operation.slipShare) {
    HandMove slip = move(hand.meant(), HandMove().speed, gripJaw);
    slip.sure = true;
    hand.add(slip);
    return;
  }
  switch (at_) {
    case At::away:
      for (int a = 0; a < 3; ++a) error_[a] = profile.perception.lateralError * random_.normal();
      hand.add(move(sight.grip - gripApproach * shaft + error_, profile.motor.strokeSpeed, gripJaw));
      at_ = At::before;
      break;
    case At::before: {
      error_ *= 0.5;
      held_ = sight.grip + gripDepth * shaft + error_;
      hand.add(move(held_, profile.motor.contactSpeed, gripJaw));
      HandMove close = move(held_, profile.motor.contactSpeed, closedJaw, button::lock);
      close.dwell = 0.2;
      close.sure = true;
      hand.add(close);
      at_ = At::closed;
      break;
    }
    case At::closed:
      at_ = At::pulling;
      pulled_ = 0.0;
      if (!sight.hand[hand_].holds) break;
      [[fallthrough]];
    case At::pulling: {
      const double wanted = wantedPull(sight, freed, divided);
      if (!(std::abs(wanted - pulled_) > 0.002)) {
        ready_ = true;
        break;
      }
      // Off the liver, and towards the patient's right.
      const Vec3 way = Vec3(0.35, -0.25, -0.9) / Vec3(0.35, -0.25, -0.9).norm();
      hand.add(move(held_ + wanted * way, pullSpeed, closedJaw, button::lock));
      pulled_ = wanted;
      break;
    }
  }
}

WorkingMind::WorkingMind(const OperationTools& tools, std::size_t hand, std::uint64_t seed)
    : tools_(tools), hand_(hand), random_(seed, 22) {}

void WorkingMind::go(const Vec3& to, double speed, double jaw, double dwell) {
  hand().add({.to = to, .speed = speed, .jaw = jaw, .dwell = dwell});
}

void WorkingMind::newError() {
  const PerformerProfile::Perception& p = tools_.profile.perception;
  const double across = p.lateralError * random_.normal();
  const double down = p.lateralError * random_.normal();
  const double along = p.depthError * random_.normal();
  error_ = tools_.scene.camera.orientation * Vec3(across, down, along);
  looks_ = 0;
}

bool WorkingMind::mount(InstrumentKind kind, double jaw) {
  if (hand().instrument() == kind) return false;
  const PerformerProfile::Motor& motor = tools_.profile.motor;
  const Vec3& home = tools_.scene.hands[hand_].home;
  const Vec3 out = hand().meant() - 0.02 * hand().shaft(hand().meant());
  const bool applier = instrumentOf(hand().instrument()).action == InstrumentAction::clip;
  const double open = applier ? 0.5 : 0.0;
  go(out, motor.contactSpeed, open);
  go(home, motor.strokeSpeed, open, exchangeRest);
  hand().add({.to = home, .jaw = jaw, .dwell = exchangeTime, .instrument = kind, .sure = true});
  return true;
}

bool WorkingMind::bring(const Vec3& place, const Vec3& hinge, double above_, double beyond, double jaw) {
  const PerformerProfile& profile = tools_.profile;
  const Vec3 shaft = hand().shaft(place);
  HandMove move;
  move.aiming = HandMove::Aim::hinge;
  move.aim = hinge;
  move.jaw = jaw;
  const std::uint32_t corrections = profile.decision.corrections + 1;
  if (looks_ == 0) {
    newError();
    move.to = place - above_ * shaft + error_;
    move.speed = profile.motor.strokeSpeed;
  } else {
    error_ *= 0.5;
    const bool over = looks_ < corrections;
    move.to = place + (over ? -0.5 * above_ : beyond) * shaft + error_;
    for (int a = 0; a < 3; ++a) move.to[a] += profile.perception.finestError * random_.normal();
    move.speed = profile.motor.contactSpeed;
  }
  hand().add(move);
  ++looks_;
  return looks_ > corrections;
}

void WorkingMind::closeAndLeave(double opened) {
  const PerformerProfile::Motor& motor = tools_.profile.motor;
  const Vec3 here = hand().meant();
  hand().add({.to = here, .jaw = closedJaw, .dwell = 0.2, .sure = true});
  hand().add({.to = here, .jaw = opened, .sure = true});
  go(here - leaving * hand().shaft(here), motor.contactSpeed, opened);
  stirred_ = true;
}

double WorkingMind::freed(const Sight& sight) const {
  double attached = 0.0;
  for (const SeenStrand& s : sight.strand) attached += s.attached ? 1.0 : 0.0;
  return attachedAtFirst_ > 0.0 ? 1.0 - attached / attachedAtFirst_ : 0.0;
}

/// The lower part of the bed is what lies nearest to where the duct comes in.
void WorkingMind::rankStrands(const Sight& sight) {
  const Vec3 from = sight.vessel.empty() ? tools_.anatomy.neck() : sight.vessel[0].centre.back();
  std::vector<std::pair<double, std::size_t>> away;
  for (const SeenStrand& strand : sight.strand) {
    away.emplace_back((strand.end[0] - from).norm(), away.size());
    attachedAtFirst_ += strand.attached ? 1.0 : 0.0;
  }
  std::sort(away.begin(), away.end());
  share_.resize(away.size());
  tried_.assign(away.size(), 0);
  for (std::size_t i = 0; i < away.size(); ++i)
    share_[away[i].second] = static_cast<double>(i) / static_cast<double>(away.size());
}

void WorkingMind::decide(const Sight& sight) {
  stirred_ = false;
  if (share_.empty() && !sight.strand.empty()) rankStrands(sight);
  const PerformerProfile::Operation& operation = tools_.profile.operation;
  if (random_.uniform() < operation.hesitationShare) {
    const double dwell = operation.hesitation * (0.5 + random_.uniform());
    if (instrumentOf(hand().instrument()).action == InstrumentAction::burn)
      hand().add({.to = hand().meant(), .dwell = dwell, .sure = true});
  }
  if (stage_ == Stage::clear)
    clear(sight);
  else if (stage_ == Stage::window)
    window(sight);
  else if (stage_ == Stage::clip)
    clip(sight);
  else if (stage_ == Stage::cut)
    cut(sight);
  else if (stage_ == Stage::last)
    divideLast(sight);
  else if (stage_ != Stage::done)
    burn(sight, stage_ == Stage::lowerThird);
}

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
