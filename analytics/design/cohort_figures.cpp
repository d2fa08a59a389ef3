// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/design/cohort_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "analytics/checkpoints/registry.h"
#include "analytics/report/study_population.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

constexpr const char* timeFigure = "elapsed-time";
constexpr const char* durationFigure = "attempt-duration";

void sortValues(DesignFigure& figure) {
  std::stable_sort(figure.values.begin(), figure.values.end(), [](const DesignValue& a, const DesignValue& b) {
    return a.person != b.person ? a.person < b.person : a.order < b.order;
  });
}

/// Mean of all items of a completed form, or none.
std::optional<double> scoreOf(const Rating& rating, const std::vector<FormItem>& items) {
  double sum = 0.0;
  for (const FormItem& item : items) {
    const auto at = rating.answers.find(item.key);
    if (at == rating.answers.end()) return std::nullopt;
    sum += at->second;
  }
  return items.empty() ? std::nullopt : std::optional(sum / static_cast<double>(items.size()));
}

}  // namespace

void addFigures(DesignData& data, const std::vector<AttemptValue>& values, const PlacedAttempts& placed,
                const StudyOptions& options, const DesignChoices& choices, const std::string& name) {
  const std::vector<std::string> unasked = unaskedPhases(options);
  const std::set<std::string> aside(unasked.begin(), unasked.end());
  std::map<std::pair<std::size_t, std::string>, DesignFigure> figures;
  std::map<std::string, std::set<std::uint32_t>> versions;
  const auto& registry = checkpointRegistry();
  for (const AttemptValue& item : values) {
    const auto at = placed.find(item.attempt);
    const CheckpointDefinition* d = findCheckpoint(item.value.name);
    if (at == placed.end() || d == nullptr || aside.count(item.value.name) > 0) continue;
    const std::string figureName = item.value.subject.empty() ? d->name : d->name + " " + item.value.subject;
    const auto named = [&](const std::string& n) { return n == d->name || n == figureName; };
    if (!d->notOutcome.empty() && !named(choices.against) &&
        std::none_of(choices.family.begin(), choices.family.end(), named))
      continue;
    const auto place =
        static_cast<std::size_t>(std::find_if(registry.begin(), registry.end(),
                                              [&](const CheckpointEntry& e) { return e.definition.name == d->name; }) -
                                 registry.begin());
    DesignFigure& figure = figures[{place, figureName}];
    figure.name = figureName;
    figure.unit = d->displayUnit == "1" ? "" : d->displayUnit;
    figure.direction = d->direction;
    versions[figureName].insert(item.value.version);
    const double shown = item.value.value.value_or(HUGE_VAL) * d->displayFactor;
    if (std::isfinite(shown))
      figure.values.push_back({at->second.person, at->second.occasion, at->second.order, at->second.completed, shown});
  }
  for (auto& [key, figure] : figures) {
    if (versions[figure.name].size() > 1) {
      if (!options.mixKeys)
        throw Error(ErrorKind::refused, Where{name},
                    fmt::format("checkpoint {} has values of {} versions", figure.name, versions[figure.name].size()),
                    {Remedy::assessAgain, Remedy::mixKeys});
      data.remarks.push_back(
          fmt::format("Values of {} versions of {} are mixed, as asked.", versions[figure.name].size(), figure.name));
    }
    sortValues(figure);
    data.figures.push_back(std::move(figure));
  }
}

void keepTimes(DesignData& data, const std::vector<AttemptValue>& values, const PlacedAttempts& placed) {
  DesignFigure times{timeFigure, "s", Direction::lower, {}};
  std::map<std::string, double> lasted;
  for (const AttemptValue& item : values) {
    if (item.value.name == durationFigure && item.value.value) lasted[item.attempt] = *item.value.value;
  }
  for (const DesignFigure& f : data.figures) {
    if (f.name != timeFigure) continue;
    for (const DesignValue& v : f.values) {
      if (v.finished) times.values.push_back(v);
    }
  }
  for (const auto& [uuid, p] : placed) {
    if (p.completed) continue;
    const auto at = lasted.find(uuid);
    times.values.push_back({p.person, p.occasion, p.order, false, at == lasted.end() ? p.seconds : at->second});
  }
  sortValues(times);
  data.figures = {std::move(times)};
}

void addForm(DesignData& data, const RatingForm& form, const std::vector<Rating>& ratings,
             const PlacedAttempts& placed) {
  std::map<std::string, std::map<std::string, double>> scores;  // by attempt, by rater
  for (const Rating& r : ratings) {
    if (r.form != form.name || r.formVersion != form.version || placed.count(r.attempt) == 0) continue;
    if (const std::optional<double> score = scoreOf(r, form.items())) scores[r.attempt][r.rater] = *score;
  }
  if (scores.empty()) return;
  DesignFigure figure{"rating " + form.name, "", Direction::higher, {}};
  DesignFigure raters = figure;
  std::map<std::size_t, std::pair<double, std::string>> first;  // of each person the earliest rated attempt
  for (const auto& [uuid, given] : scores) {
    const Placed& p = placed.at(uuid);
    double sum = 0.0;
    for (const auto& item : given) sum += item.second;
    figure.values.push_back({p.person, p.occasion, p.order, true, sum / static_cast<double>(given.size())});
    const auto at = first.find(p.person);
    if (at == first.end() || p.order < at->second.first) first[p.person] = {p.order, uuid};
  }
  for (const auto& [person, attempt] : first) {
    for (const auto& [rater, score] : scores[attempt.second])
      raters.values.push_back({person, positionIn(data.raters, rater), attempt.first, true, score});
  }
  sortValues(figure);
  data.figures.push_back(std::move(figure));
  data.rated.push_back(std::move(raters));
}

}  // namespace calot::analytics
