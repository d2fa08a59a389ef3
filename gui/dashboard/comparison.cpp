// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/comparison.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <unordered_map>

#include "analytics/checkpoints/checkpoint.h"
#include "gui/attempt/figure_text.h"

namespace calot::gui {

using analytics::AttemptRow;
using analytics::AttemptValue;
using analytics::CheckpointValue;

std::vector<std::string> comparabilityKeysOf(const std::vector<AttemptRow>& attempts) {
  std::map<std::string, int> count;
  for (const AttemptRow& a : attempts) ++count[a.comparabilityKey];
  std::vector<std::string> keys;
  keys.reserve(count.size());
  for (const auto& entry : count) keys.push_back(entry.first);
  std::ranges::stable_sort(keys, std::greater(), [&](const std::string& key) { return count[key]; });
  return keys;
}

namespace {

std::string groupName(const AttemptRow& attempt, GroupBy by) {
  const std::string& name = by == GroupBy::group     ? attempt.group
                            : by == GroupBy::profile ? attempt.profile
                                                     : attempt.participant;
  return name.empty() ? "(none)" : name;
}

using Values = std::unordered_map<std::string_view, const CheckpointValue*>;  // by attempt

Values valuesOf(const std::vector<AttemptValue>& values, const Figure& figure) {
  Values found;
  found.reserve(values.size());
  for (const AttemptValue& v : values) {
    if (v.value.name == figure.name && v.value.subject == figure.subject) found[v.attempt] = &v.value;
  }
  return found;
}

/// Unit in which such values are shown, and the factor to it.
DisplayedValue scaleOf(CheckpointValue value) {
  value.value = 1.0;
  return displayedValue(value);
}

bool isOf(const AttemptRow& attempt, const Trainee& trainee) {
  if (trainee.synthetic) return attempt.participant.empty() && attempt.profile == trainee.name;
  return attempt.participant == trainee.name;
}

std::string whyNotShown(const AttemptRow& attempt) {
  if (attempt.verification.verdict == analytics::Verdict::diverged) return "diverged";
  if (attempt.verification.verdict == analytics::Verdict::damaged) return "damaged";
  return attempt.complete ? "" : "incomplete";
}

}  // namespace

Comparison compare(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
                   const ComparisonRequest& request) {
  Comparison result;
  const Values found = valuesOf(values, request.figure);
  std::uint32_t newest = 0;
  for (const auto& entry : found) newest = std::max(newest, entry.second->version);
  std::map<std::string, ComparisonGroup> groups;
  std::map<std::pair<std::int64_t, std::string>, int> leftOut;
  const auto whyOut = [&](const AttemptRow& attempt, const CheckpointValue* value) {
    std::pair<std::int64_t, std::string> why;
    if (attempt.comparabilityKey != request.comparabilityKey) return why = {0, "of another comparability key"};
    for (const analytics::LeftOut& out : attempt.leftOut) {
      const bool waived =
          out.rule == "practice" || out.rule == "group" || (out.rule == "synthetic" && request.includeSynthetic);
      if (!waived) return why = {out.position, out.reason};
    }
    if (value != nullptr && value->version != newest) return why = {100, "with another version of the checkpoint"};
    if (value == nullptr || !value->value) why = {101, "without a value"};
    return why;
  };
  // The display unit depends on definition and unit alone, which are looked up when the unit changes.
  const std::string* unit = nullptr;
  double factor = 1.0;
  for (const AttemptRow& attempt : attempts) {
    const auto entry = found.find(attempt.uuid);
    const CheckpointValue* const value = entry == found.end() ? nullptr : entry->second;
    if (const auto why = whyOut(attempt, value); !why.second.empty()) {
      ++leftOut[why];
    } else {
      if (unit == nullptr || *unit != value->unit) {
        const DisplayedValue shown = scaleOf(*value);
        result.unit = shown.unit.toStdString();
        result.definition = analytics::definitionOf(*value);
        factor = shown.number;
        unit = &value->unit;
      }
      result.synthetic = result.synthetic || attempt.synthetic;
      ++result.shown;
      const std::string name = groupName(attempt, request.groupBy);
      ComparisonGroup& group = groups[name];
      group.name = name;
      group.point.push_back({attempt.uuid, *value->value * factor, attempt.synthetic});
    }
  }
  for (const auto& [why, count] : leftOut) result.leftOut.emplace_back(why.second, count);
  for (auto& entry : groups) {
    std::ranges::sort(entry.second.point, {}, [](const ComparisonPoint& p) { return std::tie(p.value, p.attempt); });
    result.group.push_back(std::move(entry.second));
  }
  return result;
}

std::string captionOf(const Comparison& comparison) {
  std::string leftOut;
  for (const auto& [why, count] : comparison.leftOut)
    leftOut += (leftOut.empty() ? "" : ", ") + std::to_string(count) + " " + why;
  std::string text = std::to_string(comparison.shown) + (comparison.shown == 1 ? " attempt." : " attempts.");
  if (!leftOut.empty()) text += " Left out: " + leftOut + ".";
  return text;
}

std::optional<analytics::Drawing> drawComparison(const Comparison& comparison, const std::string& title,
                                                 const analytics::PlotFrame& frame) {
  analytics::BoxPlot plot;
  plot.title = title;
  plot.axis = comparison.unit;
  plot.synthetic = comparison.synthetic;
  plot.frame = frame;
  plot.frame.legend = true;
  std::vector<std::vector<double>> values;
  for (const ComparisonGroup& group : comparison.group) {
    plot.groups.push_back(group.name);
    std::vector<double>& own = values.emplace_back();
    for (const ComparisonPoint& p : group.point) own.push_back(p.value);
  }
  plot.values.assign(values.begin(), values.end());
  plot.point = [&](std::size_t g, std::size_t i) -> analytics::BoxPlot::Point {
    const ComparisonPoint& p = comparison.group[g].point[i];
    const QString unit = QString::fromStdString(comparison.unit);
    return {p.attempt,
            comparison.group[g].name + ": " +
                (numberText(p.value, comparison.definition) + ' ' + unit).trimmed().toStdString() + '\n' + p.attempt,
            p.synthetic};
  };
  return analytics::drawBoxPlot(plot);
}

std::vector<Trainee> traineesOf(const std::vector<AttemptRow>& attempts) {
  std::set<std::string> people, profiles;
  for (const AttemptRow& attempt : attempts) {
    if (!attempt.participant.empty())
      people.insert(attempt.participant);
    else if (!attempt.profile.empty())
      profiles.insert(attempt.profile);
  }
  std::vector<Trainee> trainees;
  trainees.reserve(people.size() + profiles.size());
  for (const std::string& name : people) trainees.push_back({name, false});
  for (const std::string& name : profiles) trainees.push_back({name, true});
  return trainees;
}

std::vector<std::string> keysOf(const std::vector<AttemptRow>& attempts, const Trainee& trainee) {
  std::vector<AttemptRow> own;
  for (const AttemptRow& attempt : attempts) {
    if (isOf(attempt, trainee)) own.push_back(attempt);
  }
  return comparabilityKeysOf(own);
}

TraineeHistory historyOf(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
                         const std::vector<analytics::Norm>& norms, const Trainee& trainee, const Figure& figure,
                         const std::string& key) {
  TraineeHistory history;
  for (const AttemptRow& attempt : attempts) {
    if (!isOf(attempt, trainee)) continue;
    if (attempt.comparabilityKey == key)
      history.attempts.push_back({&attempt, std::nullopt, "no such figure"});
    else
      ++history.otherKeys;
  }
  std::ranges::sort(history.attempts, {},
                    [](const HistoryAttempt& a) { return std::tie(a.attempt->startUtc, a.attempt->uuid); });
  const Values found = valuesOf(values, figure);
  std::uint32_t newest = 0;
  DisplayedValue scale{1.0, {}};
  for (const HistoryAttempt& entry : history.attempts) {
    const auto at = found.find(entry.attempt->uuid);
    if (at == found.end() || at->second->version < newest) continue;
    newest = at->second->version;
    scale = scaleOf(*at->second);
    history.definition = analytics::definitionOf(*at->second);
  }
  history.unit = scale.unit.toStdString();
  std::vector<double> x, y;
  for (std::size_t i = 0; i < history.attempts.size(); ++i) {
    HistoryAttempt& entry = history.attempts[i];
    const auto at = found.find(entry.attempt->uuid);
    if (at == found.end()) continue;
    const CheckpointValue& value = *at->second;
    entry.why = value.reason;
    if (!value.value) continue;
    if (value.version != newest) {
      entry.why = "of an older version of the checkpoint";
      continue;
    }
    entry.why = whyNotShown(*entry.attempt);
    entry.value = scale.number * *value.value;
    if (!entry.why.empty()) continue;
    x.push_back(static_cast<double>(i + 1));
    y.push_back(*entry.value);
  }
  history.curve =
      trainee.synthetic ? analytics::NoResult{"a performer does not learn"} : analytics::fitLearningCurve(x, y);
  std::uint32_t version = 0;
  for (const analytics::Norm& norm : norms) {
    if (norm.comparabilityKey != key || norm.synthetic != trainee.synthetic) continue;
    for (const analytics::NormCheckpoint& mark : norm.checkpoints) {
      if (mark.checkpoint != figure.name || mark.subject != figure.subject || mark.version != newest || !mark.cut ||
          norm.version < version)
        continue;
      history.cut = scale.number * *mark.cut;
      version = norm.version;
    }
  }
  return history;
}

std::optional<analytics::Drawing> drawTraineeHistory(const TraineeHistory& history, const std::string& title,
                                                     const analytics::PlotFrame& frame) {
  analytics::HistoryPlot plot;
  plot.title = title;
  plot.axis = history.unit;
  plot.mark = history.cut;
  plot.frame = frame;
  plot.frame.legend = true;
  plot.attempts = static_cast<double>(history.attempts.size());
  if (history.curve) plot.curve = &*history.curve;
  for (std::size_t i = 0; i < history.attempts.size(); ++i) {
    const HistoryAttempt& entry = history.attempts[i];
    plot.synthetic = plot.synthetic || entry.attempt->synthetic;
    if (!entry.value) continue;
    const QString text = QString("Attempt %1, %2: %3 %4")
                             .arg(i + 1)
                             .arg(startText(entry.attempt->startUtc), numberText(*entry.value, history.definition),
                                  QString::fromStdString(history.unit));
    plot.values.push_back(
        {static_cast<double>(i + 1), *entry.value, !entry.why.empty(), entry.attempt->uuid, text.toStdString()});
  }
  return analytics::drawHistory(plot);
}

}  // namespace calot::gui
