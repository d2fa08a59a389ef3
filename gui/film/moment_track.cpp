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
  if (recorder::isMinimal(recording.header()))
    throw Error(ErrorKind::invalid, Where{recording.path().string()},
                "is a golden recording, which holds no results of its steps: overlays other than time, and alignment "
                "by phase, need one of `calot record`");
}

}  // namespace

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

void MomentTrack::add(const recorder::RecordedStep& step) {
  const double time = static_cast<double>(step.step + 1) * stepSeconds_;
  const StepResult& result = results_->of(step);
  for (const Event& event : judge_->observe(result).events) {
    const EventWords* const words = wordsOf(event.kind);
    if (words != nullptr) moment_.events.push_back({textOf(event, names_), words->fault, time});
  }
  smoke_.add(time, step.result.events);
  for (std::size_t h = 0; h < handCount; ++h) {
    const HandResult& hand = step.result.hand[h];
    if (hand.instrument == InstrumentKind::none)
      moment_.path[h].clear();
    else
      moment_.path[h].push_back({hand.tipSimulated, time});
  }
  if (collector_) collector_->onStep({step.step, step.samples, step.ticks, result, step.digest, step.lateness, {}, {}});
}

void MomentTrack::refreshCheckpoints(double time) {
  if (!collector_ || (checkpointsAt_ >= 0.0 && time < checkpointsAt_ + refreshSeconds)) return;
  checkpointsAt_ = time;
  moment_.checkpoints.clear();
  const std::vector<analytics::CheckpointValue> values = collector_->values();
  for (const std::string_view name : shownCheckpoints) {
    const analytics::CheckpointDefinition* const definition = analytics::findCheckpoint(name);
    if (definition == nullptr) continue;
    for (const analytics::CheckpointValue& value : values) {
      if (value.name != name || !value.value) continue;
      const double shown = *value.value * definition->displayFactor;
      const std::string unit = definition->displayUnit == "1" ? "" : " " + definition->displayUnit;
      moment_.checkpoints.push_back(
          fmt::format("{}{}{}  {}{}", name, value.subject.empty() ? "" : " ", value.subject, readable(shown), unit));
    }
  }
}

const Moment& MomentTrack::at(std::uint64_t n) {
  while (next_ <= n) add(recording_.step(next_++));
  moment_.time = static_cast<double>(next_) * stepSeconds_;
  moment_.phase = wordFor(judge_->judgement().phase);
  const auto forget = [&](auto& past, double seconds) {
    while (!past.empty() && past.front().time < moment_.time - seconds) past.pop_front();
  };
  forget(moment_.events, Moment::eventSeconds);
  for (auto& path : moment_.path) forget(path, Moment::pathSeconds);
  moment_.smoke = smoke_.at(moment_.time);
  refreshCheckpoints(moment_.time);
  return moment_;
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
