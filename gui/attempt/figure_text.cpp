// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/figure_text.h"

#include <algorithm>
#include <cmath>
#include <QDateTime>
#include <QLocale>
#include <QTimeZone>

#include "analytics/checkpoints/registry.h"
#include "analytics/report/report_text.h"
#include "gui/attempt/theme.h"

namespace calot::gui {

using analytics::Verdict;

QString badgeText(Verdict verdict) {
  const char* sign = "–";
  switch (verdict) {
    case Verdict::verified:
      sign = "✓";
      break;
    case Verdict::diverged:
      sign = "≠";
      break;
    case Verdict::damaged:
      sign = "✕";
      break;
    case Verdict::notCheckableHere:
      sign = "?";
      break;
    case Verdict::notChecked:
      break;
  }
  return QString::fromUtf8(sign) + ' ' + QString::fromStdString(analytics::nameOf(verdict));
}

Badge badgeOf(const analytics::AttemptRow& attempt) {
  Badge badge;
  badge.text = badgeText(attempt.verification.verdict);
  badge.colour = theme::ofVerdict(attempt.verification.verdict);
  switch (attempt.verification.verdict) {
    case Verdict::verified:
      badge.explanation = "The recording was simulated again and every digest and force was equal, bit for bit.";
      break;
    case Verdict::diverged:
      badge.explanation = "The recording and its re-simulation differ. This says what was found, not who caused it.";
      break;
    case Verdict::damaged:
      badge.explanation = "The recording cannot be read in full.";
      break;
    case Verdict::notCheckableHere:
      badge.explanation = "The recording was made by another simulation version, which this version cannot repeat.";
      break;
    case Verdict::notChecked:
      badge.explanation = "Nobody has simulated this recording again yet.";
      break;
  }
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
  switch (attempt.operatorKind) {
    case recorder::OperatorKind::human:
      return "(no pseudonym)";
    case recorder::OperatorKind::kinematics:
      return "(kinematics file)";
    case recorder::OperatorKind::performer:
      return "(performer)";
  }
  return {};
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
  if (definition == nullptr || definition->version != value.version || definition->unit != value.unit)
    return {value.value.value_or(0.0), value.unit == "1" ? QString() : QString::fromStdString(value.unit)};
  return {value.value.value_or(0.0) * definition->displayFactor,
          definition->displayUnit == "1" ? QString() : QString::fromStdString(definition->displayUnit)};
}

QString valueText(const analytics::CheckpointValue& value) {
  if (!value.value) return "none: " + QString::fromStdString(value.reason);
  const DisplayedValue shown = displayedValue(value);
  return shown.unit.isEmpty() ? numberText(shown.number) : numberText(shown.number) + ' ' + shown.unit;
}

QString directionText(const analytics::CheckpointValue& value) {
  const analytics::CheckpointDefinition* const definition = analytics::definitionOf(value);
  if (definition == nullptr) return "unknown to this version";
  switch (definition->direction) {
    case analytics::Direction::none:
      return "describes only";
    case analytics::Direction::lower:
      return "↓ lower is better";
    case analytics::Direction::higher:
      return "↑ higher is better";
  }
  return {};
}

QString originText(analytics::Origin origin) { return QString::fromStdString(analytics::nameOf(origin)); }

QString figureTitle(const std::string& name, const std::string& subject) {
  const analytics::CheckpointDefinition* const definition = analytics::findCheckpoint(name);
  const QString title = QString::fromStdString(definition != nullptr ? definition->title : name);
  return subject.empty() ? title : title + ", " + QString::fromStdString(subject);
}

}  // namespace calot::gui
