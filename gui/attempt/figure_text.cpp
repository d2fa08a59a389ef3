// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/figure_text.h"

#include <fmt/format.h>
#include <cmath>
#include <map>
#include <QLocale>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/report/attempt_sheet.h"
#include "analytics/report/figure_number.h"
#include "analytics/statistics/descriptive.h"
#include "gui/attempt/widget_parts.h"
#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"

namespace calot::gui {

using analytics::Verdict;

namespace {

struct VerdictWords {
  const char *sign, *explanation;
};

VerdictWords wordsOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::verified:
      return {"✓", "The recording was simulated again and every digest and force was equal, bit for bit."};
    case Verdict::diverged:
      return {"≠", "The recording and its re-simulation differ. This says what was found, not who caused it."};
    case Verdict::damaged:
      return {"✕", "The recording cannot be read in full."};
    case Verdict::notCheckableHere:
      return {"?", "The recording was made by another simulation version, which this version cannot repeat."};
    case Verdict::notChecked:
      break;
  }
  return {"–", "Nobody has simulated this recording again yet."};
}

std::vector<double> competentValues(const analytics::Norm& norm, std::size_t figure) {
  std::vector<double> values;
  for (const analytics::NormMember& member : norm.members) {
    if (member.competent && figure < member.values.size() && member.values[figure])
      values.push_back(*member.values[figure]);
  }
  std::sort(values.begin(), values.end());
  return values;
}

std::optional<FigureStanding::Band> bandOf(const std::vector<double>& sorted, double factor) {
  if (sorted.size() < analytics::leastForPercentile) return std::nullopt;
  const auto at = [&](double p) { return factor * analytics::quantileOfSorted(sorted, p); };
  return FigureStanding::Band{at(0.10), at(0.25), at(0.50), at(0.75), at(0.90)};
}

void judge(FigureStanding& standing, const analytics::GradedFigure& figure) {
  standing.passed = figure.passed;
  standing.open = figure.open;
  standing.undecided = figure.undecided;
  if (figure.rank) standing.percentile = *figure.rank;
  if (figure.passed) {
    standing.explanation = *figure.passed ? "On the passing side of the norm's cut." : "Falls short of the norm's cut.";
    if (figure.open) standing.explanation += " Within the cut's interval: another norm might judge otherwise.";
    if (figure.undecided)
      standing.explanation += " Not decided by this simulation: the cut lies within the value's interval.";
  } else if (!figure.missing.empty()) {
    standing.explanation = "Not judged: " + figure.missing + ".";
  }
  if (figure.rank)
    standing.explanation += fmt::format(" Percentile {:.0f} of {} competent members.", *figure.rank, figure.competent);
  else if (figure.value)
    standing.explanation += " No percentile: " + figure.rank.reason() + ".";
}

}  // namespace

QString badgeText(Verdict verdict) {
  return QString::fromUtf8(wordsOf(verdict).sign) + ' ' + QString::fromStdString(analytics::nameOf(verdict));
}

Badge badgeOf(const analytics::AttemptRow& attempt) {
  const Verdict verdict = attempt.verification.verdict;
  Badge badge{badgeText(verdict), wordsOf(verdict).explanation, theme::ofVerdict(verdict)};
  if (!attempt.verification.text.empty())
    badge.explanation += "\nFound: " + QString::fromStdString(attempt.verification.text);
  if (!attempt.verification.software.empty())
    badge.explanation += "\nJudged by " + QString::fromStdString(attempt.verification.software) +
                         (attempt.verifiedUtc.empty() ? QString() : ", " + startText(attempt.verifiedUtc)) + '.';
  return badge;
}

QString modeText(recorder::Mode mode) { return wordFor(mode); }

QString outcomeText(recorder::Outcome outcome) {
  return outcome == recorder::Outcome::running ? "incomplete" : wordFor(outcome);
}

QString operatorText(const analytics::AttemptRow& attempt) {
  if (!attempt.participant.empty()) return QString::fromStdString(attempt.participant);
  if (!attempt.profile.empty()) return QString::fromStdString(attempt.profile);
  if (attempt.operatorKind == recorder::OperatorKind::human) return "(no pseudonym)";
  return attempt.operatorKind == recorder::OperatorKind::kinematics ? "(kinematics file)" : "(performer)";
}

QString startText(const std::string& startUtc) { return QString::fromStdString(analytics::localTime(startUtc)); }

QString numberText(double value, const analytics::CheckpointDefinition* of) {
  if (analytics::isWrittenWhole(of, value)) return QLocale().toString(std::llround(value));
  const double magnitude = std::abs(value);
  if (magnitude < analytics::arithmeticDust) return QLocale().toString(0);
  if (magnitude < 1e-6 || magnitude >= 1e15) return QLocale().toString(value, 'e', 3);
  const int decimals = std::clamp(3 - static_cast<int>(std::floor(std::log10(magnitude))), 0, 9);
  return QLocale().toString(value, 'f', decimals);
}

DisplayedValue displayedValue(const analytics::CheckpointValue& value) {
  const analytics::CheckpointDefinition* const definition = analytics::definitionOf(value);
  const bool known = definition != nullptr && definition->version == value.version && definition->unit == value.unit;
  const std::string& unit = known ? definition->displayUnit : value.unit;
  return {value.value.value_or(0.0) * (known ? definition->displayFactor : 1.0),
          unit == "1" ? QString() : QString::fromStdString(unit)};
}

QString valueText(const analytics::CheckpointValue& value) {
  if (!value.value) return "none: " + QString::fromStdString(value.reason);
  const DisplayedValue shown = displayedValue(value);
  const QString number = numberText(shown.number, analytics::definitionOf(value));
  return shown.unit.isEmpty() ? number : number + ' ' + shown.unit;
}

QString directionText(const analytics::CheckpointValue& value) {
  const analytics::CheckpointDefinition* const definition = analytics::definitionOf(value);
  if (definition == nullptr) return "unknown to this version";
  if (definition->direction == analytics::Direction::none) return "describes only";
  return definition->direction == analytics::Direction::lower ? "↓ lower is better" : "↑ higher is better";
}

QString originText(analytics::Origin origin) { return QString::fromStdString(analytics::nameOf(origin)); }

QString figureTitle(const std::string& name, const std::string& subject) {
  const analytics::CheckpointDefinition* const definition = analytics::findCheckpoint(name);
  const QString title = QString::fromStdString(definition != nullptr ? definition->title : name);
  return subject.empty() ? title : title + ", " + QString::fromStdString(subject);
}

std::vector<const analytics::Norm*> normsFor(const analytics::AttemptRow& attempt,
                                             const std::vector<analytics::Norm>& norms) {
  std::map<std::string, const analytics::Norm*> newest;
  for (const analytics::Norm& norm : norms) {
    if (norm.comparabilityKey != attempt.comparabilityKey) continue;
    const analytics::Norm*& kept = newest[norm.name];
    if (kept == nullptr || kept->version < norm.version) kept = &norm;
  }
  std::vector<const analytics::Norm*> result;
  result.reserve(newest.size());
  for (const auto& entry : newest) result.push_back(entry.second);
  return result;
}

AttemptStanding standingOf(const analytics::AttemptRow& attempt, const std::vector<analytics::CheckpointValue>& values,
                           const analytics::Norm& norm, const std::vector<analytics::ValueInterval>& intervals) {
  AttemptStanding standing;
  standing.norm = fmt::format("{} version {}", norm.name, norm.version);
  std::optional<analytics::Grade>& grade = standing.grade;
  try {
    // Alone: how the participant's attempts went over time is the trainee page's.
    std::vector<analytics::AttemptValue> own;
    own.reserve(values.size());
    for (const analytics::CheckpointValue& value : values) {
      const analytics::ValueInterval* interval = analytics::findInterval(intervals, value);
      own.push_back({attempt.uuid, value, interval != nullptr ? std::optional(*interval) : std::nullopt});
    }
    grade = analytics::gradeAttempt(attempt, {attempt}, own, norm, false, "this cohort");
    standing.verdict = grade->verdict;
    standing.judged = true;
  } catch (const Error& error) {
    standing.verdict = "Not judged: " + problemText(error);
  }
  for (std::size_t f = 0; f < norm.checkpoints.size(); ++f) {
    const analytics::NormCheckpoint& mark = norm.checkpoints[f];
    const analytics::CheckpointDefinition* definition =
        mark.metric ? &mark.metric->definition : analytics::findCheckpoint(mark.checkpoint);
    const double factor =
        definition != nullptr && definition->version == mark.version ? definition->displayFactor : 1.0;
    FigureStanding figure;
    figure.checkpoint = mark.checkpoint;
    figure.subject = mark.subject;
    figure.band = bandOf(competentValues(norm, f), factor);
    if (mark.cut) figure.cut = factor * *mark.cut;
    const auto value = std::find_if(values.begin(), values.end(), [&](const analytics::CheckpointValue& v) {
      return v.name == mark.checkpoint && v.subject == mark.subject && v.version == mark.version;
    });
    if (value != values.end() && value->value) figure.value = factor * *value->value;
    if (grade) {
      const auto graded = std::find_if(grade->figures.begin(), grade->figures.end(), [&](const auto& g) {
        return g.mark.checkpoint == mark.checkpoint && g.mark.subject == mark.subject;
      });
      if (graded != grade->figures.end()) judge(figure, *graded);
    }
    if (!figure.band)
      figure.explanation +=
          fmt::format(" No band: fewer than {} competent members have this figure.", analytics::leastForPercentile);
    standing.figures.push_back(std::move(figure));
  }
  return standing;
}

}  // namespace calot::gui
