// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/step_comparison.h"

#include <fmt/format.h>

#include "recorder/recording/layout.h"

namespace calot::recorder {

StepComparison::StepComparison(Recording& recording, Engine& engine)
    : recording_(recording),
      engine_(engine),
      compareResult_(recording.header()),
      minimal_(isMinimal(recording.header())),
      exactForces_(recording.header().formatVersion == 1) {}

void StepComparison::compare(const EngineStep& step) {
  if (first_) {
    if (!resolved_) resolveAtKeyframe(step);
    return;
  }
  const RecordedStep& recorded = recording_.step(step.step);
  for (std::size_t i = 0; !minimal_ && i < step.ticks.size() && !first_; ++i) {
    first_ = compareTick(step.step, step.step * step.ticks.size() + i, recorded.ticks[i],
                         exactForces_ ? step.ticks[i] : asStored(step.ticks[i]));
  }
  if (!first_ && (minimal_ || !exactForces_) && forceDigest(step.ticks) != recorded.forces)
    first_ = Divergence{step.step, {}, "force", "digest of the step's forces", ""};
  if (!first_) first_ = compareDigests(recorded, step);
  if (!first_) first_ = compareResult_(recorded.result, step.result);
  if (!first_ && !minimal_ && step.procedure != nullptr)
    first_ = compareProcedure(step.step, recorded.procedure, *step.procedure);
  if (first_) {
    resolved_ = minimal_ || !first_->detail.empty();
    if (!resolved_) resolveAtKeyframe(step);
    return;
  }
  if (const auto index = keyframeAt(step.step)) {
    first_ = compareKeyframe(*index);
    resolved_ = true;
  }
}

std::optional<Divergence> StepComparison::compareDigests(const RecordedStep& recorded, const EngineStep& step) {
  const DigestLayout& layout = recording_.header().layout;
  if (minimal_ || exactForces_) return compareDigest(step.step, layout, recorded.digest, step.digest);
  shorten(step.digest, brief_);
  return compareDigest(step.step, layout, recorded.brief, brief_);
}

std::optional<Divergence> StepComparison::compareKeyframe(std::size_t index) {
  const Keyframe recorded = recording_.keyframe(index);
  const Keyframe here = engine_.keyframe();
  if (recorded.state == here.state && recorded.haptics == here.haptics) return std::nullopt;
  const auto difference = engine_.explain(recorded).value_or(KeyframeDifference{"bytes", ""});
  return Divergence{here.step, {}, "keyframe", difference.field, difference.detail};
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
void StepComparison::resolveAtKeyframe(const EngineStep& step) {
  const auto index = keyframeAt(step.step);
  if (!index) return;
  resolved_ = true;
  if (const auto d = compareKeyframe(*index)) {
    first_->detail = step.step == first_->step
                         ? fmt::format("{} {}", d->field, d->detail)
                         : fmt::format("at the next keyframe, step {}: {} {}", step.step, d->field, d->detail);
  }
}

}  // namespace calot::recorder
