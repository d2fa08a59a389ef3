// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/checkpoints/collector.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/motion.h"
#include "analytics/checkpoints/phases.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"
#include "recorder/recorded_results.h"
#include "recorder/sources/tracked_motion.h"
#include "sim/judgement/judge.h"

namespace calot::analytics {

void ForceTrack::add(const recorder::StepRecord& record) {
  const std::size_t ticks = std::min(record.samples.size(), record.ticks.size());
  for (std::size_t t = 0; t < ticks; ++t) {
    for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h) {
      Newest& newest = newest_[h];
      if (record.samples[t].hand[h].instrument == InstrumentKind::none) {
        newest.ticks = 0;
        continue;
      }
      HandForces& hand = hand_[h];
      hand.mounted = true;
      const Vec3& f = record.ticks[t].hand[h].force;
      const double magnitude = lengthOf(f);
      hand.largest = std::max(hand.largest, magnitude);
      hand.sum += magnitude;
      if (magnitude >= leastForce) hand.felt.push_back(magnitude);
      if (newest.ticks >= 2 && lengthOf(newest.force[1]) >= leastForce)
        hand.rates.push_back(lengthOf(f - newest.force[0]) / (2.0 * tickSeconds_));
      newest.force = {newest.force[1], f};
      newest.ticks = std::min(newest.ticks + 1, 2);
    }
  }
}

void ForceTrack::interrupt() {
  for (Newest& newest : newest_) newest.ticks = 0;
}

void PhaseForceTrack::add(const recorder::StepRecord& record, Phase phase) {
  const std::size_t window = windowOf(phase);
  if (window < track_.size()) {
    if (phase != phase_) track_[window].interrupt();
    track_[window].add(record);
  }
  phase_ = phase;
}

CheckpointCollector::CheckpointCollector(const recorder::AttemptHeader& header, const SceneDescription& scene,
                                         Origin origin, double cutoff)
    : origin_(origin),
      cutoff_(cutoff),
      tickSeconds_(header.tickSeconds),
      ticksPerStep_(header.ticksPerStep),
      track_{trackFor(header), trackFor(header)},
      judge_(scene),
      force_(header.tickSeconds),
      phaseForce_(header.tickSeconds) {
  assert(origin != Origin::samples);
  const bool procedure = !scene.procedure.specimen.empty();
  const AttemptContext context{
      header.tickSeconds,       header.ticksPerStep, header.structures(),
      header.stepResultVersion, procedure,           header.handedness,
      sceneFacts(scene),        subjectNames(scene), notAssessed(scene, header.stepResultVersion)};
  for (const CheckpointEntry& entry : checkpointRegistry()) checkpoint_.push_back(entry.make(context));
}

void CheckpointCollector::onStep(const recorder::StepRecord& record) { take(record, judge_.observe(record.result)); }

void CheckpointCollector::take(const recorder::StepRecord& record, const Judgement& judgement) {
  assert(!ended_);
  for (const TickSamples& tick : record.samples) {
    for (std::size_t h = 0; h < track_.size(); ++h) track_[h].add(tick.hand[h]);
  }
  force_.add(record);
  phaseForce_.add(record, judgement.phase);
  phases_.add(judgement.phase, ticksPerStep_);
  for (const Event& event : record.result.events) {
    if (event.kind == EventKind::clockStretched) stretched_ += event.value;
  }
  for (const auto& checkpoint : checkpoint_) checkpoint->onStep(record, judgement);
  ++steps_;
}

void CheckpointCollector::onEnd(recorder::Outcome outcome) {
  outcome_ = outcome;
  ended_ = true;
}

std::vector<CheckpointValue> CheckpointCollector::values() const {
  const std::array<Motion, handCount> motion{track_[0].motion(cutoff_), track_[1].motion(cutoff_)};
  const std::vector<PhaseMotion> phases = phases_.cut(motion, tickSeconds_);
  const AttemptEnd end{.steps = steps_,
                       .stretched = stretched_,
                       .outcome = outcome_,
                       .origin = origin_,
                       .motion = {&motion[0], &motion[1]},
                       .phases = &phases,
                       .force = &force_,
                       .phaseForce = &phaseForce_};
  std::vector<CheckpointValue> result;
  for (const auto& checkpoint : checkpoint_) {
    for (CheckpointValue& value : checkpoint->values(end)) result.push_back(std::move(value));
  }
  return result;
}

std::vector<CheckpointValue> valuesFromObservables(recorder::Recording& recording, double cutoff,
                                                   recorder::Observer* also) {
  const recorder::AttemptHeader& header = recording.header();
  const SceneDescription scene = recorder::sceneFromAssets(header.assets).description;
  CheckpointCollector collector(header, scene, Origin::observables, cutoff);
  recorder::RecordedResults results(header, scene);
  std::vector<recorder::Observer*> observers{&collector};
  if (also != nullptr) observers.push_back(also);
  recorder::feedRecorded(recording, observers, &results);
  return collector.values();
}

namespace {

/// A longer interval, in the tracker's own, hides a sample whose pose equalled the previous one.
constexpr double unseenIntervals = 1.5;

}  // namespace

std::vector<CheckpointValue> valuesFromSamples(const recorder::TrackedMotion& tracked, const SamplesContext& context) {
  const std::array<Motion, handCount> motion{motionOf(tracked, 0, context.cutoff),
                                             motionOf(tracked, 1, context.cutoff)};
  const std::vector<PhaseMotion> phases;
  const std::uint64_t steps = tracked.time.size() - 1;
  AttemptContext attempt;
  attempt.handedness = context.handedness;
  attempt.ticksPerStep = 1;
  attempt.tickSeconds = tracked.time.back() / static_cast<double>(steps);
  const ForceTrack force(attempt.tickSeconds);
  const AttemptEnd end{.steps = steps,
                       .outcome = context.outcome,
                       .origin = Origin::samples,
                       .motion = {&motion[0], &motion[1]},
                       .phases = &phases,
                       .force = &force};
  std::vector<CheckpointValue> values;
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    const std::vector<Origin>& origins = entry.definition.origins;
    if (std::find(origins.begin(), origins.end(), Origin::samples) == origins.end()) continue;
    for (CheckpointValue& value : entry.make(attempt)->values(end)) values.push_back(std::move(value));
  }
  return values;
}

MotionTrack::MotionTrack(double tickSeconds, double sourceRate)
    : tickSeconds_(tickSeconds), rowsPerTick_(sourceRate * tickSeconds), grid_(1.0 / tickSeconds) {
  assert(tickSeconds > 0.0 && sourceRate >= 0.0);
}

bool MotionTrack::isDue() const {
  if (rowsPerTick_ <= 0.0 || tick_ == 0) return true;
  // Half a row's thousandth keeps rounding from moving a row by a tick.
  const double t = static_cast<double>(tick_);
  return std::floor(t * rowsPerTick_ + 5e-4) > std::floor((t - 1.0) * rowsPerTick_ + 5e-4);
}

/// The newest sample's pose stood for longer than a source holds one.
bool MotionTrack::rested() const { return seconds(vouched_ - sample_) > straightBridge; }

/// Extends the grid to the end: the newest sample vouches for rest beyond 0.1 s.
void MotionTrack::closeRest(SampleGrid& grid) const {
  if (!grid.runs().empty() && rested()) grid.extend(static_cast<double>(vouched_), position_, orientation_);
}

/// A held pose is no measurement: without rest, a pause begins at the newest sample.
MotionTrack::Pause MotionTrack::pauseUntil(std::int64_t tick) const {
  if (instrument_ == InstrumentKind::none) return {mountedAt_, tick, true};
  return {rested() ? vouched_ : sample_, tick, false};
}

void MotionTrack::unmount() {
  if (instrument_ != InstrumentKind::none) closeRest(grid_);
  if (mountedAt_ >= 0) {
    if (instrument_ == InstrumentKind::none || tick_ - vouched_ > 1) pauses_.push_back(pauseUntil(tick_));
    mounted_.push_back({seconds(mountedAt_), seconds(tick_)});
  }
  instrument_ = InstrumentKind::none;
  mountedAt_ = -1;
  vouched_ = sample_ = tick_;  // nothing more to close
}

void MotionTrack::begin(const InstrumentSample& sample, bool continues) {
  closeRest(grid_);
  grid_.begin(static_cast<double>(tick_), sample.position, sample.orientation, continues);
  interval_ = 1;
}

void MotionTrack::sampled(const InstrumentSample& sample) {
  if (tick_ - vouched_ > 1) {  // interrupted
    const std::int64_t from = rested() ? vouched_ : sample_;
    if (!rested()) rate_.add(seconds(tick_ - sample_));
    if (seconds(tick_ - from) > straightBridge) {
      begin(sample, true);
      return;
    }
    closeRest(grid_);
  } else if (seconds(tick_ - sample_) > straightBridge) {
    const std::int64_t until = std::max(tick_ - interval_, sample_ + 1);
    if (until < tick_) grid_.extend(static_cast<double>(until), position_, orientation_);
  } else {
    interval_ = tick_ - sample_;
    rate_.add(seconds(interval_));
  }
  grid_.extend(static_cast<double>(tick_), sample.position, sample.orientation);
}

void MotionTrack::add(const InstrumentSample& sample) {
  ++tick_;
  if (sample.instrument == InstrumentKind::none) {
    unmount();
    return;
  }
  if (mountedAt_ < 0) mountedAt_ = tick_;
  if (!sample.valid) return;
  const bool first = instrument_ == InstrumentKind::none;
  const bool same = sample.instrument == instrument_;
  if (first ? tick_ > mountedAt_ : tick_ - vouched_ > 1) pauses_.push_back(pauseUntil(tick_));
  const bool moved = sample.position != position_ || sample.orientation.coeffs() != orientation_.coeffs();
  if (!same) {
    begin(sample, false);
  } else if (seconds(tick_ - vouched_) > straightBridge) {
    sampled(sample);  // lost for longer than a source holds a pose: a sample, moved or not
  } else if (!moved || !isDue()) {
    vouched_ = tick_;
    return;
  } else {
    sampled(sample);
  }
  instrument_ = sample.instrument;
  sample_ = vouched_ = tick_;
  position_ = sample.position;
  orientation_ = sample.orientation;
}

MotionCoverage MotionTrack::coverage(double interval) const {
  MotionCoverage coverage{mounted_, {}};
  std::vector<Pause> pauses = pauses_;
  const std::int64_t end = tick_ + 1;
  if (mountedAt_ >= 0) {
    coverage.mounted.push_back({seconds(mountedAt_), seconds(end)});
    if (instrument_ == InstrumentKind::none || vouched_ < tick_) pauses.push_back(pauseUntil(end));
  }
  const GapRule rule{interval};
  for (const Pause& pause : pauses) {
    const double pauseSeconds = seconds(pause.to - pause.from);
    if (pause.atStart) {
      coverage.lost.push_back({seconds(pause.from), seconds(pause.to)});
    } else if (rule.isGap(pauseSeconds)) {
      coverage.lost.push_back({seconds(pause.to) - rule.lost(pauseSeconds), seconds(pause.to)});
    }
  }
  coverage.mounted = normalized(std::move(coverage.mounted));
  coverage.lost = normalized(std::move(coverage.lost));
  return coverage;
}

Motion MotionTrack::motion(double cutoff) const {
  MotionSamples samples{grid_, rate_, unseenIntervals * rate_.interval(), coverage(rate_.interval()), true};
  closeRest(samples.grid);
  return filteredMotion(std::move(samples), cutoff);
}

MotionTrack trackFor(const recorder::AttemptHeader& header) {
  // A kinematics file's rows were interpolated to ticks by its source; a device that plays one holds them.
  const recorder::Provenance& from = header.provenance;
  const bool interpolated = from.kind == recorder::OperatorKind::kinematics && from.device.empty();
  return MotionTrack(header.tickSeconds, interpolated ? recorder::kinematicsRowsPerSecond : 0.0);
}

std::array<Motion, handCount> motionOf(recorder::Recording& recording, double cutoff) {
  std::array<MotionTrack, handCount> track{trackFor(recording.header()), trackFor(recording.header())};
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    for (const TickSamples& tick : recording.step(n).samples) {
      for (std::size_t h = 0; h < track.size(); ++h) track[h].add(tick.hand[h]);
    }
  }
  return {track[0].motion(cutoff), track[1].motion(cutoff)};
}

}  // namespace calot::analytics
