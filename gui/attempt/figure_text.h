// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of tables for stored values. Numbers are shown in the user's locale (a German sees a decimal comma);
// nothing is ever read back from such a text.
#pragma once

#include <QColor>
#include <QString>

#include "analytics/cohort/cohort_database.h"

namespace calot::gui {

/// A verdict as sign, word and colour: the sign and the word carry it, the colour (Okabe and Ito's, darkened for text
/// on white) only helps.
struct Badge {
  QString text;         ///< "✓ verified"
  QString explanation;  ///< one or more sentences, with what was found, by what and when
  QColor colour;
};
[[nodiscard]] Badge badgeOf(const analytics::AttemptRow& attempt);
/// Sign and word of a verdict alone.
[[nodiscard]] QString badgeText(analytics::Verdict verdict);

[[nodiscard]] QString modeText(recorder::Mode mode);           ///< "practice", "assessment"
[[nodiscard]] QString outcomeText(recorder::Outcome outcome);  ///< "completed", "time limit", ...
/// Participant's pseudonym; else the performer's profile; else what kind of source it was.
[[nodiscard]] QString operatorText(const analytics::AttemptRow& attempt);
[[nodiscard]] QString startText(const std::string& startUtc);  ///< "2026-02-03 14:05 UTC"; as stored if it is no date

/// Four significant digits, never an exponent between 0.000001 and 10^15; 0 below analytics::arithmeticDust.
[[nodiscard]] QString numberText(double value);

/// A value at the edge: in the unit that its definition displays.
struct DisplayedValue {
  double number = 0.0;
  QString unit;
};
/// @pre value.value has a number. Without a definition of the same version it stays in SI.
[[nodiscard]] DisplayedValue displayedValue(const analytics::CheckpointValue& value);
[[nodiscard]] QString valueText(const analytics::CheckpointValue& value);      ///< "12.5 mm", or why there is none
[[nodiscard]] QString directionText(const analytics::CheckpointValue& value);  ///< "lower is better", ...
[[nodiscard]] QString originText(analytics::Origin origin);
/// "Path length of the instrument's tip, left"
[[nodiscard]] QString figureTitle(const std::string& name, const std::string& subject);

}  // namespace calot::gui
