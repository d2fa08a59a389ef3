// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/attempt_report.h"

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

#include "analytics/assess.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/collector.h"
#include "analytics/report/key_figures.h"
#include "gui/attempt/figure_text.h"
#include "recorder/base/errors.h"
#include "recorder/recording/reader.h"

namespace calot::gui {
namespace {

using Access = analytics::CohortDatabase::Access;

bool isThere(const std::filesystem::path& cohort) {
  std::error_code ignored;
  return !cohort.empty() && std::filesystem::exists(cohort, ignored);
}

const analytics::CheckpointValue* sameFigure(const std::vector<analytics::CheckpointValue>& values,
                                             const analytics::CheckpointValue& as) {
  const auto at = std::find_if(values.begin(), values.end(), [&](const analytics::CheckpointValue& v) {
    return v.name == as.name && v.subject == as.subject && v.version == as.version;
  });
  return at == values.end() ? nullptr : &*at;
}

/// @param of the value whose checkpoint the number belongs to
QString withUnit(double number, const analytics::CheckpointValue& of) {
  const QString text = numberText(number, analytics::definitionOf(of)), unit = displayedValue(of).unit;
  return unit.isEmpty() ? text : text + ' ' + unit;
}

QString normWords(const FigureStanding& standing, const analytics::CheckpointValue& of) {
  QString text;
  if (standing.cut) text = "pass mark " + withUnit(*standing.cut, of);
  if (standing.band) {
    text += text.isEmpty() ? "half of the competent people " : ", half of the competent people ";
    text += numberText(standing.band->p25, analytics::definitionOf(of)) + " to " + withUnit(standing.band->p75, of);
  }
  if (standing.passed) text += *standing.passed ? ": reached" : ": falls short";
  if (standing.passed && standing.undecided) text += " (not decided by this simulation)";
  return text;
}

/// @param judges both attempts were completed: who did less of a task was not better at it
QString beforeWords(const analytics::CheckpointValue& now, const analytics::CheckpointValue& before, bool judges) {
  if (!before.value) return {};
  const QString then = valueText(before);
  if (!now.value) return then;
  const DisplayedValue a = displayedValue(before), b = displayedValue(now);
  const double change = b.number - a.number;
  constexpr double nothing = 1e-6;  // of what is shown: rounding, as of the path of a tip that stands still
  if (numberText(a.number) == numberText(b.number) || std::abs(change) < nothing) return then + ", the same";
  const QString by = withUnit(std::abs(change), now);
  const analytics::CheckpointDefinition* const definition = analytics::definitionOf(now);
  const auto direction = definition != nullptr ? definition->direction : analytics::Direction::none;
  if (!judges || direction == analytics::Direction::none)
    return then + (change > 0.0 ? ", now more by " : ", now less by ") + by;
  const bool better = (change < 0.0) == (direction == analytics::Direction::lower);
  return then + (better ? ", better by " : ", worse by ") + by;
}

}  // namespace

AttemptFacts readFacts(const std::filesystem::path& file, const std::filesystem::path& cohort) {
  AttemptFacts facts;
  recorder::Recording recording(file);
  const std::string uuid = recording.header().attempt;
  if (isThere(cohort)) {
    const analytics::CohortDatabase database(cohort.string(), Access::read);
    if (auto row = database.attempt(uuid)) {
      facts.attempt = std::move(*row);
      facts.values = database.values(uuid);
      facts.intervals = database.intervals(uuid);
      facts.inCohort = true;
      return facts;
    }
  }
  const recorder::ChainVerdict chain = recording.verifyChain();
  if (!chain.intact())
    throw Error(ErrorKind::refused, Where{file.string()}, "its content does not agree with its chain: no figures");
  recorder::ReplayReport own;
  own.outcome = recording.outcome();
  own.complete = recording.complete();
  own.steps = recording.stepCount();
  analytics::AttemptRecord& record = facts.attempt;
  record = analytics::recordOf(recording.header(), own, file.string());
  record.verification = {};  // nothing was re-simulated
  if (own.steps > 0) facts.values = analytics::valuesFromObservables(recording);
  return facts;
}

std::optional<AttemptFacts> previousInCohort(const AttemptFacts& now, const std::filesystem::path& cohort) {
  if (now.attempt.participant.empty() || !isThere(cohort)) return std::nullopt;
  const analytics::CohortDatabase database(cohort.string(), Access::read);
  std::optional<analytics::AttemptRow> newest;
  for (analytics::AttemptRow& row : database.listAttempts()) {  // by start
    if (row.uuid == now.attempt.uuid || row.startUtc > now.attempt.startUtc) continue;
    if (row.participant != now.attempt.participant || row.comparabilityKey != now.attempt.comparabilityKey) continue;
    if (!row.parent.empty() || !row.complete || row.synthetic != now.attempt.synthetic) continue;
    newest = std::move(row);
  }
  if (!newest) return std::nullopt;
  AttemptFacts facts;
  facts.values = database.values(newest->uuid);
  facts.attempt = std::move(*newest);
  facts.inCohort = true;
  return facts;
}

std::vector<analytics::Norm> normsOf(const std::filesystem::path& cohort) {
  if (!isThere(cohort)) return {};
  return analytics::CohortDatabase(cohort.string(), Access::read).norms();
}

AttemptReport reportOf(AttemptFacts now, const std::optional<AttemptFacts>& previous,
                       const std::vector<analytics::Norm>& norms) {
  AttemptReport report;
  const std::vector<const analytics::Norm*> fitting = normsFor(now.attempt, norms);
  std::optional<AttemptStanding> standing;
  if (!fitting.empty()) standing = standingOf(now.attempt, now.values, *fitting.front(), now.intervals);
  const bool judged = standing && standing->judged;
  report.summary = summaryOf(now.attempt, now.values, judged && standing->grade ? &*standing->grade : nullptr);
  if (!standing)
    report.norm = "No norm for this task, device and mode.";
  else if (judged)
    report.norm =
        QString("Norm %1: %2").arg(QString::fromStdString(standing->norm), QString::fromStdString(standing->verdict));
  else
    report.norm = QString("Norm %1: judged when the attempt is verified and in the cohort.")
                      .arg(QString::fromStdString(standing->norm));
  report.previous = previous ? "Last time: " + startText(previous->attempt.startUtc) + ", " +
                                   outcomeText(previous->attempt.outcome) + '.'
                             : QString("No earlier attempt at this task to compare with.");
  const bool judges = now.attempt.outcome == recorder::Outcome::completed && previous &&
                      previous->attempt.outcome == recorder::Outcome::completed;
  for (const analytics::KeyFigure& figure : analytics::keyFigures(now.values, nullptr)) {
    const analytics::CheckpointValue& value = figure.value;
    FigureReport& line = report.figures.emplace_back();
    line.title = QString::fromStdString(figure.title);
    line.now = value.value ? valueText(value) : QString::fromStdString(value.reason);
    const FigureStanding* const stands = standing ? entryOf(standing->figures, value) : nullptr;
    if (stands != nullptr) line.norm = normWords(*stands, value);
    const analytics::CheckpointValue* const then = previous ? sameFigure(previous->values, value) : nullptr;
    if (then != nullptr) line.before = beforeWords(value, *then, judges);
  }
  report.facts = std::move(now);
  return report;
}

Lesson lessonOf(const std::filesystem::path& parent, const std::filesystem::path& branch) {
  recorder::Recording before(parent), now(branch);
  const AttemptTrack a = readTrack(before), b = readTrack(now);
  const std::optional<double> parting = partingTime(a, b);
  if (!parting)
    throw Error(ErrorKind::refused, Where{branch.string()}, "is no branch of " + parent.filename().string());
  Lesson lesson;
  lesson.seconds = std::max(0.0, std::min(a.seconds, b.seconds) - *parting);
  lesson.figures = stretchFigures({&a, &b}, {*parting, *parting}, lesson.seconds);
  return lesson;
}

}  // namespace calot::gui
