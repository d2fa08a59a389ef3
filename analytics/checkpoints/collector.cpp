// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/collector.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "analytics/checkpoints/force.h"
#include "analytics/checkpoints/phases.h"
#include "analytics/checkpoints/recorded_motion.h"
#include "analytics/checkpoints/registry.h"
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

}  // namespace calot::analytics
