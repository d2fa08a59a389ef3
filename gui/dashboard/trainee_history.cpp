// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/trainee_history.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/report/plots.h"
#include "gui/attempt/figure_text.h"

namespace calot::gui {
namespace {

bool isOf(const analytics::AttemptRow& attempt, const Trainee& trainee) {
  if (trainee.synthetic) return attempt.participant.empty() && attempt.profile == trainee.name;
  return attempt.participant == trainee.name;
}

std::string whyNotShown(const analytics::AttemptRow& attempt) {
  if (attempt.verification.verdict == analytics::Verdict::diverged) return "diverged";
  if (attempt.verification.verdict == analytics::Verdict::damaged) return "damaged";
  return attempt.complete ? "" : "incomplete";
}

}  // namespace

std::vector<Trainee> traineesOf(const std::vector<analytics::AttemptRow>& attempts) {
  std::set<std::string> people, profiles;
  for (const analytics::AttemptRow& attempt : attempts) {
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

std::vector<std::string> keysOf(const std::vector<analytics::AttemptRow>& attempts, const Trainee& trainee) {
  std::vector<analytics::AttemptRow> own;
  for (const analytics::AttemptRow& attempt : attempts) {
    if (isOf(attempt, trainee)) own.push_back(attempt);
  }
  return comparabilityKeysOf(own);
}

TraineeHistory historyOf(const std::vector<analytics::AttemptRow>& attempts,
                         const std::vector<analytics::AttemptValue>& values, const std::vector<analytics::Norm>& norms,
                         const Trainee& trainee, const Figure& figure, const std::string& key) {
  TraineeHistory history;
  for (const analytics::AttemptRow& attempt : attempts) {
    if (!isOf(attempt, trainee)) continue;
    if (attempt.comparabilityKey == key)
      history.attempts.push_back({&attempt, std::nullopt, "no such figure"});
    else
      ++history.otherKeys;
  }
  std::sort(history.attempts.begin(), history.attempts.end(), [](const HistoryAttempt& a, const HistoryAttempt& b) {
    return std::tie(a.attempt->startUtc, a.attempt->uuid) < std::tie(b.attempt->startUtc, b.attempt->uuid);
  });
  std::map<std::string, const analytics::CheckpointValue*> found;
  std::uint32_t newest = 0;
  for (const analytics::AttemptValue& value : values) {
    if (value.value.name == figure.name && value.value.subject == figure.subject) found[value.attempt] = &value.value;
  }
  for (const HistoryAttempt& entry : history.attempts) {
    const auto at = found.find(entry.attempt->uuid);
    if (at != found.end()) newest = std::max(newest, at->second->version);
  }
  const analytics::CheckpointDefinition* definition = analytics::findCheckpoint(figure.name);
  const bool known = definition != nullptr && definition->version == newest;
  const double factor = known ? definition->displayFactor : 1.0;
  if (known && definition->displayUnit != "1") history.unit = definition->displayUnit;
  std::vector<double> x, y;
  for (std::size_t i = 0; i < history.attempts.size(); ++i) {
    HistoryAttempt& entry = history.attempts[i];
    const auto at = found.find(entry.attempt->uuid);
    if (at == found.end()) continue;
    entry.why = at->second->reason;
    if (!at->second->value) continue;
    if (!known && history.unit.empty() && at->second->unit != "1") history.unit = at->second->unit;
    if (at->second->version != newest) {
      entry.why = "of an older version of the checkpoint";
      continue;
    }
    entry.why = whyNotShown(*entry.attempt);
    entry.value = factor * *at->second->value;
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
      history.cut = factor * *mark.cut;
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
    const QString text =
        QString("Attempt %1, %2: %3 %4")
            .arg(i + 1)
            .arg(startText(entry.attempt->startUtc), numberText(*entry.value), QString::fromStdString(history.unit));
    plot.values.push_back(
        {static_cast<double>(i + 1), *entry.value, !entry.why.empty(), entry.attempt->uuid, text.toStdString()});
  }
  return analytics::drawHistory(plot);
}

}  // namespace calot::gui
