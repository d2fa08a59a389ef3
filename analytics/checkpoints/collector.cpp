// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/checkpoints/collector.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cassert>

#include "analytics/checkpoints/force.h"
#include "analytics/checkpoints/motion.h"
#include "analytics/checkpoints/motion_track.h"
#include "analytics/checkpoints/phases.h"
#include "analytics/checkpoints/registry.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"
#include "recorder/recorded_results.h"
#include "sim/judgement/judge.h"

namespace calot::analytics {
struct CheckpointCollector::Storage {
  Storage(const recorder::AttemptHeader& header, const SceneDescription& scene, Origin from, double cut)
      : origin(from),
        cutoff(cut),
        tickSeconds(header.tickSeconds),
        ticksPerStep(header.ticksPerStep),
        track{trackFor(header), trackFor(header)},
        judge(scene),
        force(header.tickSeconds),
        phaseForce(header.tickSeconds) {
    const bool procedure = !scene.procedure.specimen.empty();
    const AttemptContext context{header.tickSeconds, header.ticksPerStep, header.structures(), header.stepResultVersion,
                                 procedure,          header.handedness,   sceneFacts(scene)};
    for (const CheckpointEntry& entry : checkpointRegistry()) checkpoint.push_back(entry.make(context));
  }
  Origin origin;
  double cutoff;
  double tickSeconds;
  std::uint64_t ticksPerStep;
  std::array<MotionTrack, handCount> track;
  PhaseTrack phases;
  Judge judge;
  ForceTrack force;
  PhaseForceTrack phaseForce;
  std::vector<std::unique_ptr<Checkpoint>> checkpoint;
  std::uint64_t steps = 0;
  double stretched = 0.0;
  recorder::Outcome outcome = recorder::Outcome::running;
  bool ended = false;
};

CheckpointCollector::CheckpointCollector(const recorder::AttemptHeader& header, const SceneDescription& scene,
                                         Origin origin, double cutoff)
    : storage_(std::make_unique<Storage>(header, scene, origin, cutoff)) {
  assert(origin != Origin::samples);
}

CheckpointCollector::~CheckpointCollector() = default;

void CheckpointCollector::onStep(const recorder::StepRecord& record) {
  take(record, storage_->judge.observe(record.result));
}

void CheckpointCollector::take(const recorder::StepRecord& record, const Judgement& judgement) {
  assert(!storage_->ended);
  for (const TickSamples& tick : record.samples) {
    for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h) storage_->track[h].add(tick.hand[h]);
  }
  storage_->force.add(record);
  storage_->phaseForce.add(record, judgement.phase);
  storage_->phases.add(judgement.phase, storage_->ticksPerStep);
  for (const Event& event : record.result.events) {
    if (event.kind == EventKind::clockStretched) storage_->stretched += event.value;
  }
  for (const auto& checkpoint : storage_->checkpoint) checkpoint->onStep(record, judgement);
  ++storage_->steps;
}

void CheckpointCollector::onEnd(recorder::Outcome outcome) {
  storage_->outcome = outcome;
  storage_->ended = true;
}

std::vector<CheckpointValue> CheckpointCollector::values() const {
  std::array<Motion, handCount> motion;
  AttemptEnd end;
  end.steps = storage_->steps;
  end.stretched = storage_->stretched;
  end.outcome = storage_->outcome;
  end.origin = storage_->origin;
  end.force = &storage_->force;
  end.phaseForce = &storage_->phaseForce;
  for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h) {
    motion[h] = storage_->track[h].motion(storage_->cutoff);
    end.motion[h] = &motion[h];
  }
  const std::vector<PhaseMotion> phases = storage_->phases.cut(motion, storage_->tickSeconds);
  end.phases = &phases;
  std::vector<CheckpointValue> result;
  for (const auto& checkpoint : storage_->checkpoint) {
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

Motion motionOf(const recorder::TrackedMotion& tracked, std::size_t hand, double cutoff) {
  const recorder::TrackedHand& rows = tracked.hand[hand];
  Motion motion;
  motion.cutoff = cutoff;
  if (!rows.present) return motion;
  // Rows of a fixed rate are counted, so that no time is rounded.
  const bool counted = tracked.rate > 0.0;
  const auto since = [&](std::size_t i) {
    return counted ? 1.0 / tracked.rate : tracked.time[i] - tracked.time[i - 1];
  };
  MotionSamples samples{SampleGrid(counted ? tracked.rate : 1.0), {}, 0.0, {}, rows.oriented};
  for (std::size_t i = 0; i < rows.position.size(); ++i) {
    const double time = counted ? static_cast<double>(i) : tracked.time[i];
    if (i > 0) samples.rate.add(since(i));
    if (i == 0 || since(i) > straightBridge) {
      samples.grid.begin(time, rows.position[i], rows.orientation[i], i > 0);
    } else {
      samples.grid.extend(time, rows.position[i], rows.orientation[i]);
    }
  }
  const GapRule rule(samples.rate.interval());
  samples.longestRate = rule.longestEven();
  samples.coverage.mounted = {{0.0, tracked.time.back()}};
  for (std::size_t i = 1; i < tracked.time.size(); ++i) {
    if (rule.isGap(since(i))) samples.coverage.lost.push_back({tracked.time[i] - rule.lost(since(i)), tracked.time[i]});
  }
  return filteredMotion(std::move(samples), cutoff);
}

std::vector<CheckpointValue> valuesFromSamples(const recorder::TrackedMotion& tracked, const SamplesContext& context) {
  const std::array<Motion, handCount> motion{motionOf(tracked, 0, context.cutoff),
                                             motionOf(tracked, 1, context.cutoff)};
  const std::vector<PhaseMotion> phases;
  AttemptContext attempt;
  attempt.handedness = context.handedness;
  AttemptEnd end;
  end.steps = tracked.time.size() - 1;
  attempt.ticksPerStep = 1;
  attempt.tickSeconds = tracked.time.back() / static_cast<double>(end.steps);
  const ForceTrack force(attempt.tickSeconds);
  end.outcome = context.outcome;
  end.origin = Origin::samples;
  end.motion = {&motion[0], &motion[1]};
  end.phases = &phases;
  end.force = &force;
  std::vector<CheckpointValue> values;
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    const std::vector<Origin>& origins = entry.definition.origins;
    if (std::find(origins.begin(), origins.end(), Origin::samples) == origins.end()) continue;
    for (CheckpointValue& value : entry.make(attempt)->values(end)) values.push_back(std::move(value));
  }
  return values;
}

}  // namespace calot::analytics
