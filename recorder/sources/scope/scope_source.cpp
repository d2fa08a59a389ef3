// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "recorder/sources/scope/scope_source.h"

#include <cmath>
#include <utility>

#include "sim/math/floating_point.h"
#include "sim/math/random.h"

namespace calot::recorder {

ScopeSource::ScopeSource(std::unique_ptr<SampleSource> source, const Endoscope& endoscope,
                         std::unique_ptr<ScopeDriver> driver)
    : WrappedSource(*source), owned_(std::move(source)), endoscope_(endoscope), driver_(std::move(driver)) {
  motion_.setOut(endoscope_.start());
  driver_->setOut(endoscope_.start());
}

void ScopeSource::setOutFrom(const CameraSample& camera) {
  const FloatingPointScope environment;
  const ScopeJoints joints = endoscope_.jointsOf(camera);
  motion_.setOut(joints);
  driver_->setOut(joints);
}

bool ScopeSource::next(std::uint64_t tick, TickSamples& out) {
  TickSamples samples;
  if (!source_.next(tick, samples)) return false;
  const FloatingPointScope environment;
  motion_.advance(driver_->wish(static_cast<double>(tick) * tickLength, motion_.joints(), samples));
  samples.camera = endoscope_.pose(motion_.joints());
  out = roundedToGrid(samples);
  return true;
}

void ScopeSource::rest() {
  source_.rest();
  driver_->rest();
}

namespace {

constexpr std::uint64_t scopeStream = 29;               // of random numbers; the hands have others
constexpr double driftLower = 0.02, driftUpper = 0.1;   // of the camera head (Hz)
constexpr double speedMemory = 0.3;                     // s
constexpr double restWeight = 0.01, pedalWeight = 0.1;  // of a tip at rest, and of a pedal more (m/s)
constexpr double settledShare = 0.3;                    // of the dead zone: near enough to the centre
constexpr std::uint8_t working = button::cutPedal | button::coagulatePedal | button::fire;

Unsteadiness driftOf(double amplitude, std::uint64_t seed) {
  Random random(seed, scopeStream);
  return {amplitude, driftLower, driftUpper, random};
}

}  // namespace

ScopeAssistant::ScopeAssistant(const Endoscope& endoscope, const ScopeSkill& skill, std::uint64_t seed)
    : endoscope_(endoscope), skill_(skill), drift_(driftOf(skill.horizonError, seed)), aim_(endoscope.start()) {}

void ScopeAssistant::watch(const TickSamples& hands) {
  for (std::size_t h = 0; h < handCount; ++h) {
    const InstrumentSample& hand = hands.hand[h];
    Tip& tip = tip_[h];
    tip.works = (hand.buttons & working) != 0;
    if (!hand.valid || hand.instrument == InstrumentKind::none) {
      tip.there = tip.there && hand.instrument != InstrumentKind::none;
      continue;
    }
    if (tip.there) {
      const double speed = (hand.position - tip.position).norm() / tickLength;
      tip.speed += tickLength / speedMemory * (speed - tip.speed);
    }
    tip.there = true;
    tip.position = hand.position;
  }
}

void ScopeAssistant::look(const ScopeJoints& present) {
  double sum = 0.0;
  Vec3 work = Vec3::Zero();
  for (const Tip& tip : tip_) {
    if (!tip.there) continue;
    const double weight = restWeight + tip.speed + (tip.works ? pedalWeight : 0.0);
    work += weight * tip.position;
    sum += weight;
  }
  if (!(sum > 0.0)) return;
  work /= sum;
  const auto seen = pointInPicture(endoscope_.frame(), endoscope_.pose(present), work);
  const double off = seen ? std::sqrt(seen->right * seen->right + seen->down * seen->down) : 2.0 * skill_.deadZone;
  if (following_ ? off < settledShare * skill_.deadZone : off <= skill_.deadZone) {
    following_ = false;
    return;
  }
  following_ = true;
  aim_ = endoscope_.aimedAt(work, endoscope_.workingDistance(), aim_);
}

ScopeJoints ScopeAssistant::wish(double time, const ScopeJoints& present, const TickSamples& hands) {
  watch(hands);
  if (time >= nextLook_) {
    look(present);
    nextLook_ = time + skill_.reaction;
  }
  ScopeJoints to = aim_;
  to.head = drift_.at(time).x();
  return to;
}

}  // namespace calot::recorder
