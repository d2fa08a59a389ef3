// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/figure_text.h"

#include <algorithm>
#include <cmath>
#include <QDateTime>
#include <QLocale>
#include <QTimeZone>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/report/report_document.h"
#include "gui/attempt/theme.h"

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

QString startText(const std::string& startUtc) {
  const QString stored = QString::fromStdString(startUtc);
  const QDateTime time = QDateTime::fromString(stored, Qt::ISODate);
  return time.isValid() ? time.toUTC().toString("yyyy-MM-dd hh:mm") + " UTC" : stored;
}

QString numberText(double value) {
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
  return shown.unit.isEmpty() ? numberText(shown.number) : numberText(shown.number) + ' ' + shown.unit;
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

}  // namespace calot::gui
