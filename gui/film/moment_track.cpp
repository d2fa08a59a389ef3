// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/moment_track.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/phases.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"
#include "recorder/recording/layout.h"

namespace calot::gui {
namespace {

/// Checkpoints for a film: those that a viewer can follow.
constexpr std::array<std::string_view, 8> shownCheckpoints{
    "path-length",  "fat-remaining", "connective-remaining", "connective-torn",
    "organ-burned", "clip-errors",   "critical-errors",      "organ-perforations"};
constexpr double refreshSeconds = 1.0;  // updating more often costs time and is not readable

/// Counts are shown in full, other figures with three significant digits and without powers of ten.
std::string readable(double value) {
  const double size = std::abs(value);
  if (size >= 100.0 || value == std::round(value)) return fmt::format("{:.0f}", value);
  return fmt::format("{:.{}f}", value, size >= 10.0 ? 1 : size >= 1.0 ? 2 : 3);
}

/// Every step's result is needed.
void refuseLean(const recorder::Recording& recording) {
  if (!hasResults(recording))
    throw Error(ErrorKind::invalid, Where{recording.path().string()},
                "is a golden recording, which holds no results of its steps: overlays other than time, and alignment "
                "by phase, need one of `calot record`");
}

}  // namespace

bool hasResults(const recorder::Recording& recording) { return !recorder::isMinimal(recording.header()); }

MomentTrack::MomentTrack(const std::filesystem::path& recording, bool checkpoints) : recording_(recording) {
  refuseLean(recording_);
  const recorder::AttemptHeader& header = recording_.header();
  const SceneDescription scene = recorder::sceneFromAssets(header.assets).description;
  results_.emplace(header, scene);
  judge_.emplace(scene);
  stepSeconds_ = header.tickSeconds * header.ticksPerStep;
  names_.structures = header.structures();
  if (checkpoints)
    collector_ = std::make_unique<analytics::CheckpointCollector>(header, scene, analytics::Origin::observables);
}

MomentTrack::~MomentTrack() = default;

void MomentTrack::add(const recorder::RecordedStep& step) {
  const double time = static_cast<double>(step.step + 1) * stepSeconds_;
  const StepResult& result = results_->of(step);
  for (const Event& event : judge_->observe(result).events) {
    const EventWords* const words = wordsOf(event.kind);
    if (words != nullptr) told_.push_back({time, textOf(event, names_), words->fault});
  }
  smoke_.add(time, step.result.events);
  for (std::size_t h = 0; h < handCount; ++h) {
    const HandResult& hand = step.result.hand[h];
    if (hand.instrument == InstrumentKind::none)
      passed_[h].clear();
    else
      passed_[h].push_back({time, hand.tipSimulated});
  }
  if (collector_) collector_->onStep({step.step, step.samples, step.ticks, result, step.digest, step.lateness, {}, {}});
}

void MomentTrack::refreshCheckpoints(double time) {
  if (!collector_ || (checkpointsAt_ >= 0.0 && time < checkpointsAt_ + refreshSeconds)) return;
  checkpointsAt_ = time;
  checkpoints_.clear();
  const std::vector<analytics::CheckpointValue> values = collector_->values();
  for (const std::string_view name : shownCheckpoints) {
    const analytics::CheckpointDefinition* const definition = analytics::findCheckpoint(name);
    if (definition == nullptr) continue;
    for (const analytics::CheckpointValue& value : values) {
      if (value.name != name || !value.value) continue;
      const double shown = *value.value * definition->displayFactor;
      const std::string unit = definition->displayUnit == "1" ? "" : " " + definition->displayUnit;
      checkpoints_.push_back(
          fmt::format("{}{}{}  {}{}", name, value.subject.empty() ? "" : " ", value.subject, readable(shown), unit));
    }
  }
}

Moment MomentTrack::at(std::uint64_t n) {
  while (next_ <= n) add(recording_.step(next_++));
  Moment moment;
  moment.time = static_cast<double>(next_) * stepSeconds_;
  moment.phase = wordFor(judge_->judgement().phase);
  while (!told_.empty() && told_.front().time < moment.time - eventSeconds) told_.pop_front();
  for (const Told& told : told_) moment.events.push_back({told.text, told.fault, moment.time - told.time});
  for (std::size_t h = 0; h < handCount; ++h) {
    std::deque<Passed>& passed = passed_[h];
    while (!passed.empty() && passed.front().time < moment.time - pathSeconds) passed.pop_front();
    for (const Passed& place : passed) moment.path[h].push_back({place.p_W, moment.time - place.time});
  }
  moment.smoke = smoke_.at(moment.time);
  refreshCheckpoints(moment.time);
  moment.checkpoints = checkpoints_;
  return moment;
}

std::array<double, 4> phaseStarts(const std::filesystem::path& path) {
  recorder::Recording recording(path);
  refuseLean(recording);
  const double stepSeconds = recording.header().tickSeconds * recording.header().ticksPerStep;
  recorder::RecordedJudge judge(recording.header());
  std::array<double, 4> starts{-1.0, -1.0, -1.0, -1.0};
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const Phase phase = judge.observe(recording.step(n)).phase;
    for (std::size_t p = 0; p < starts.size(); ++p)
      if (analytics::windowPhases[p] == phase && starts[p] < 0.0) starts[p] = static_cast<double>(n) * stepSeconds;
  }
  return starts;
}

}  // namespace calot::gui
