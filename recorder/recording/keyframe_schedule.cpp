// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/keyframe_schedule.h"

#include <algorithm>
#include <cmath>

namespace calot::recorder {

namespace {

/// Time of a step of the whole operation by what it reports, from a fit to all steps of one on one machine (ms).
/// Nothing but the spacing of keyframes depends on it: too large makes them closer, too small makes seeks longer.
constexpr double workOfStep = 0.2;
constexpr double workOfOrganIteration = 0.018;
constexpr double workOfFatIteration = 0.009;
constexpr double workOfContactRow = 0.017;
constexpr double workOfPass = 0.16;
constexpr double workOfCarving = 0.65;

/// State of the scene that the fit was made in, nothing carved yet.
constexpr double fittedStateBytes = 190e3;

/// Work between two keyframes (ms).
constexpr double maxWork = 125.0;

constexpr double longestSeconds = 1.0;

double workOf(const StepResult& result) {
  double work = workOfStep;
  for (const OrganResult& organ : result.organ) work += workOfOrganIteration * organ.iterations;
  for (const FatResult& fat : result.fat) {
    work += workOfFatIteration * fat.iterations;
    if (fat.carved > 0.0) work += workOfCarving;
  }
  return work + workOfContactRow * result.contact.rows + workOfPass * result.contact.passes;
}

}  // namespace

KeyframeSchedule::KeyframeSchedule(const Layout& layout, double tickSeconds) : stepsPerBlock_(layout.stepsPerBlock) {
  const double blockSeconds = static_cast<double>(layout.ticksPerBlock) * tickSeconds;
  const double blocks = std::clamp(std::floor(longestSeconds / blockSeconds + 0.5), 1.0, 1e6);
  longest_ = stepsPerBlock_ * static_cast<std::uint64_t>(blocks);
}

bool KeyframeSchedule::dueAfter(const StepResult& result) {
  ++steps_;
  ++since_;
  blockWork_ += workOf(result);
  if (steps_ % stepsPerBlock_ != 0) return false;
  work_ += blockWork_;
  // Would another block like this be too much?
  const bool much = (work_ + blockWork_) * std::max(size_, 1.0) > maxWork;
  blockWork_ = 0.0;
  return much || since_ >= longest_;
}

void KeyframeSchedule::taken(std::size_t stateBytes) {
  if (size_ <= 0.0) size_ = std::max(1e-3, static_cast<double>(stateBytes) / fittedStateBytes);
  since_ = 0;
  work_ = 0.0;
}

}  // namespace calot::recorder
