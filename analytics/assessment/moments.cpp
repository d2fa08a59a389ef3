// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/moments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/collector.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"
#include "recorder/recorded_results.h"

namespace calot::analytics {
namespace {

constexpr double minWindow = 1.0;  // s
constexpr double maxWindows = 200.0;
constexpr std::size_t maxMoments = 3;
constexpr double standsOut = 2.0;  // times the mean
/// A figure whose filter looks ahead falls a little where its newest points are not settled yet.
constexpr double settled = 0.02;

}  // namespace

FigureMoments momentsOf(const std::vector<double>& series, double length, Direction better) {
  FigureMoments result;
  const double worse = better == Direction::higher ? -1.0 : 1.0;
  const auto first = std::find_if(series.begin(), series.end(), [](double v) { return std::isfinite(v); });
  if (first == series.end()) {
    result.none = "the recording's steps do not give this figure";
    return result;
  }
  // A figure that begins with the attempt begins at zero; one known only later, or counting down, begins when known.
  double before = first == series.begin() && better != Direction::higher ? 0.0 : *first;
  std::vector<double> gained;
  double total = 0.0;
  for (const double value : series) {
    gained.push_back(std::isfinite(value) ? worse * (value - before) : 0.0);
    if (std::isfinite(value)) before = value;
    total += std::max(0.0, gained.back());
  }
  if (!(total > 0.0) || std::any_of(gained.begin(), gained.end(), [&](double g) { return g < -settled * total; })) {
    result.none = "a figure of the whole attempt: it does not add up over time";
    return result;
  }
  std::vector<std::size_t> order(gained.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return gained[a] > gained[b]; });
  order.resize(std::min(order.size(), maxMoments));
  std::sort(order.begin(), order.end());
  const double mean = total / static_cast<double>(gained.size());
  for (const std::size_t w : order) {
    if (gained[w] < standsOut * mean || !(gained[w] > 0.0)) continue;
    const Moment moment{static_cast<double>(w) * length, static_cast<double>(w + 1) * length, gained[w] / total};
    if (!result.moments.empty() && moment.begin == result.moments.back().end) {
      result.moments.back().end = moment.end;
      result.moments.back().share += moment.share;
    } else {
      result.moments.push_back(moment);
    }
  }
  if (result.moments.empty()) result.none = "it grew evenly: no moment stands out";
  return result;
}

AttemptMoments findMoments(recorder::Recording& recording,
                           const std::vector<std::pair<std::string, std::string>>& figures,
                           const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  const recorder::AttemptHeader& header = recording.header();
  const SceneDescription scene = recorder::sceneFromAssets(header.assets).description;
  CheckpointCollector collector(header, scene, Origin::observables);
  recorder::RecordedResults results(header, scene);
  Judge judge(scene);
  const double stepSeconds = header.tickSeconds * static_cast<double>(header.ticksPerStep);
  const std::uint64_t steps = recording.stepCount();
  const double wanted = std::max(minWindow, static_cast<double>(steps) * stepSeconds / maxWindows);
  const auto window = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(wanted / stepSeconds)));
  std::vector<std::vector<double>> series(figures.size());
  for (std::uint64_t n = 0; n < steps; ++n) {
    const recorder::RecordedStep& step = recording.step(n);
    if (step.result.organ.size() != scene.organs.size())
      throw Error(ErrorKind::damaged, Where{recording.path().string(), "/observables"},
                  "has other organs than the scene in /scene");
    const StepResult& result = results.of(step);
    collector.take({step.step, step.samples, step.ticks, result, step.digest, step.lateness, {}, {}},
                   judge.observe(result));
    if (n + 1 == steps) collector.onEnd(recording.outcome());
    if ((n + 1) % window != 0 && n + 1 != steps) continue;
    const std::vector<CheckpointValue> values = collector.values();
    for (std::size_t f = 0; f < figures.size(); ++f) {
      const auto at = std::find_if(values.begin(), values.end(), [&](const CheckpointValue& v) {
        return v.name == figures[f].first && v.subject == figures[f].second;
      });
      series[f].push_back(at != values.end() && at->value ? *at->value : NAN);
    }
    if (progress) progress(n + 1, steps);
  }
  AttemptMoments result{{}, linesOf(judge.judgement().errorList, subjectNames(scene), stepSeconds)};
  for (std::size_t f = 0; f < figures.size(); ++f) {
    const CheckpointDefinition* definition = findCheckpoint(figures[f].first);
    FigureMoments moments = momentsOf(series[f], static_cast<double>(window) * stepSeconds,
                                      definition == nullptr ? Direction::lower : definition->direction);
    if (definition == nullptr) {
      moments = {};
      moments.none = "a metric of a script has one value of the whole attempt";
    }
    moments.checkpoint = figures[f].first;
    moments.subject = figures[f].second;
    for (Moment& m : moments.moments) m.end = std::min(m.end, static_cast<double>(steps) * stepSeconds);
    result.figures.push_back(std::move(moments));
  }
  return result;
}

}  // namespace calot::analytics
