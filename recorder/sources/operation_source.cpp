// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/operation_source.h"

#include <algorithm>
#include <utility>

#include "sim/math/floating_point.h"

namespace calot::recorder {
namespace {

constexpr double atHome = 0.5;  // at home before the start, at rest after the end (s)

}  // namespace

OperationSource::OperationSource(const PerformerProfile& profile, const SceneDescription& scene, std::uint64_t seed)
    : profile_(profile),
      scene_(scene),
      anatomy_(scene_, worker),
      hand_{PerformerHand(profile_, scene_.hands[0], 0, seed), PerformerHand(profile_, scene_.hands[1], 1, seed)},
      holding_({profile_, scene_, anatomy_, hand_}, 1 - worker, seed),
      working_({profile_, scene_, anatomy_, hand_}, worker, seed),
      judge_(scene),
      random_(seed, 23) {
  provenance_.kind = OperatorKind::performer;
  provenance_.profile = profile.name;
  provenance_.profileVersion = profile.version;
}

Outcome OperationSource::ending() const { return gaveUp_ ? Outcome::abandoned : Outcome::completed; }

void OperationSource::onStep(const StepRecord& record) {
  const FloatingPointScope environment;
  for (const Event& event : judge_.observe(record.result).events) {
    if (event.kind == EventKind::clipHalfOn && event.hand == worker) ++badClips_;
  }
  if (!wantsToLook_) return;
  wantsToLook_ = false;
  sight_ = anatomy_.look(record);
}

void OperationSource::decide(double time) {
  const Sight sight = std::move(*sight_);
  sight_.reset();
  for (; badClips_ > 0; --badClips_) working_.sawBadClip();
  const double freed = working_.freed(sight);
  if (hand_[1 - worker].idle(time)) holding_.decide(sight, freed, working_.divided());
  if (hand_[worker].idle(time) && holding_.ready() && !working_.done()) working_.decide(sight);
  if (working_.done() && endAt_ < 0.0) gaveUp_ = working_.failed();
  if (time > profile_.operation.patience) gaveUp_ = true;
}

/// A hand that is to go on will have nothing more to do.
bool OperationSource::idleIn(double seconds, double time) const {
  return hand_[worker].idleIn(seconds, time) || (!holding_.ready() && hand_[1 - worker].idleIn(seconds, time));
}

bool OperationSource::next(std::uint64_t tick, TickSamples& out) {
  const FloatingPointScope environment;
  const double time = static_cast<double>(tick) * tickLength;
  if (gaveUp_ && !working_.done()) return false;
  if (working_.done() && hand_[worker].idle(time)) {
    if (endAt_ < 0.0) endAt_ = time + atHome;
    if (time >= endAt_) return false;
  }
  if (sight_ && time >= decideAt_ && idleIn(0.0, time)) decide(time);
  const PerformerProfile::Perception& p = profile_.perception;
  const double ahead = working_.stirs() ? 0.0 : profile_.operation.anticipation * p.reactionTime;
  if (time >= atHome && idleIn(ahead, time) && !wantsToLook_ && !sight_ && !working_.done()) {
    wantsToLook_ = true;
    decideAt_ = time + std::clamp(p.reactionTime + p.reactionSpread * random_.normal(), 0.15, 0.6);
  }
  TickSamples samples;
  for (std::size_t h = 0; h < handCount; ++h) samples.hand[h] = hand_[h].sample(time);
  samples.camera = scene_.camera;
  out = roundedToGrid(samples);
  return true;
}

}  // namespace calot::recorder
