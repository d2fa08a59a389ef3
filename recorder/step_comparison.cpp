// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/step_comparison.h"

#include <fmt/format.h>

#include "recorder/recording/layout.h"

namespace calot::recorder {

StepComparison::StepComparison(Recording& recording, const Model& model)
    : recording_(recording),
      model_(model),
      compareResult_(recording.header()),
      minimal_(isMinimal(recording.header())),
      exactForces_(recording.header().formatVersion == 1) {}

void StepComparison::onStep(const StepRecord& record) {
  if (first_) {
    if (!resolved_) resolveAtKeyframe(record);
    return;
  }
  const RecordedStep& recorded = recording_.step(record.step);
  for (std::size_t i = 0; !minimal_ && i < record.ticks.size() && !first_; ++i) {
    first_ = compareTick(record.step, record.step * record.ticks.size() + i, recorded.ticks[i],
                         exactForces_ ? record.ticks[i] : asStored(record.ticks[i]));
  }
  if (!first_ && (minimal_ || !exactForces_) && forceDigest(record.ticks) != recorded.forces)
    first_ = Divergence{record.step, {}, "force", "digest of the step's forces", ""};
  if (!first_) first_ = compareDigests(recorded, record);
  if (!first_) first_ = compareResult_(recorded.result, record.result);
  if (first_) {
    resolved_ = minimal_ || !first_->detail.empty();
    if (!resolved_) resolveAtKeyframe(record);
    return;
  }
  if (const auto index = keyframeAt(record.step)) {
    first_ = compareKeyframe(model_, recording_.keyframe(*index), record.keyframe());
    resolved_ = true;
  }
}

std::optional<Divergence> StepComparison::compareDigests(const RecordedStep& recorded, const StepRecord& record) {
  const DigestLayout& layout = recording_.header().layout;
  if (minimal_ || exactForces_) return compareDigest(record.step, layout, recorded.digest, record.digest);
  shorten(record.digest, brief_);
  return compareDigest(record.step, layout, recorded.brief, brief_);
}

void StepComparison::fail(Divergence divergence) {
  if (!first_) first_ = std::move(divergence);
  resolved_ = true;
}

std::optional<std::size_t> StepComparison::keyframeAt(std::uint64_t step) {
  const auto index = recording_.keyframeAtOrBefore(step);
  return index && recording_.keyframeSteps()[*index] == step ? index : std::nullopt;
}

/// Digests say which field differs, not where: the next keyframe holds the values.
void StepComparison::resolveAtKeyframe(const StepRecord& record) {
  const auto index = keyframeAt(record.step);
  if (!index) return;
  resolved_ = true;
  if (const auto d = compareKeyframe(model_, recording_.keyframe(*index), record.keyframe())) {
    first_->detail = record.step == first_->step
                         ? fmt::format("{} {}", d->field, d->detail)
                         : fmt::format("at the next keyframe, step {}: {} {}", record.step, d->field, d->detail);
  }
}

}  // namespace calot::recorder
