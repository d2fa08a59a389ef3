// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of tables for stored values. Numbers are shown in the user's locale (a German sees a decimal comma);
// nothing is ever read back from such a text. Then: where an attempt's figures stand within a norm, and its summary.
#pragma once

#include <algorithm>
#include <optional>
#include <QColor>
#include <QString>
#include <string>
#include <vector>

#include "analytics/assessment/grade.h"
#include "analytics/cohort/cohort_database.h"
#include "gui/words/attempt_summary.h"

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
[[nodiscard]] QString startText(
    const std::string& startUtc);  ///< "2026-02-03 14:05", by the clock here; as stored if it is no date

/// Four significant digits, never an exponent between 0.000001 and 10^15; 0 below analytics::arithmeticDust.
/// @param of the checkpoint whose value it is, as it displays it: a count is whole (analytics::isWrittenWhole()); null:
/// of none
[[nodiscard]] QString numberText(double value, const analytics::CheckpointDefinition* of = nullptr);

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

/// One figure against the competent members of a norm; everything in the unit that the checkpoint displays.
struct FigureStanding {
  std::string checkpoint, subject;
  /// Quantiles of type 7 of the competent members; none where fewer than analytics::leastForPercentile have the figure.
  struct Band {
    double p10 = 0.0, p25 = 0.0, p50 = 0.0, p75 = 0.0, p90 = 0.0;
  };
  std::optional<Band> band;
  std::optional<double> value, cut;
  std::optional<double> percentile;  ///< 0 to 100, of the competent; 100: none of them was better
  std::optional<bool> passed;
  bool open = false;        ///< the value lies within the interval of the cut
  bool undecided = false;   ///< the cut lies within the simulation's interval of the value
  std::string explanation;  ///< sentences for a person
};

/// The entry of a list that is of this figure, or null.
template <class Entry>
const Entry* entryOf(const std::vector<Entry>& list, const analytics::CheckpointValue& value) {
  const auto at = std::find_if(list.begin(), list.end(), [&](const Entry& e) {
    return e.checkpoint == value.name && e.subject == value.subject;
  });
  return at == list.end() ? nullptr : &*at;
}

/// How the whole attempt stands.
struct AttemptStanding {
  std::string norm;     ///< "residents version 2"
  std::string verdict;  ///< one sentence; or why there is no judgement
  bool judged = false;
  std::optional<analytics::Grade> grade;  ///< where it is judged; alone, without the participant's other attempts
  std::vector<FigureStanding> figures;
};

/// Names of the norms that an attempt can be held against, those of its own comparability key, newest version of each
/// name; by name.
std::vector<const analytics::Norm*> normsFor(const analytics::AttemptRow& attempt,
                                             const std::vector<analytics::Norm>& norms);

/// An attempt that did not verify, or is not whole, is not judged: the verdict then says why, and the bands stand.
AttemptStanding standingOf(const analytics::AttemptRow& attempt, const std::vector<analytics::CheckpointValue>& values,
                           const analytics::Norm& norm, const std::vector<analytics::ValueInterval>& intervals = {});

}  // namespace calot::gui
