// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of an attempt in words: one sentence each, alike in figures, sheets, films, windows and the page.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/judgement/judge.h"

namespace calot::analytics {

/// Names in the order of event subject indices.
struct SubjectNames {
  std::vector<std::string> structures;
  std::vector<std::string> connective;  ///< connective tissues; may be left empty
};

/// The names of a scene's structures and connective tissues.
SubjectNames subjectNames(const SceneDescription& scene);

/// "cystic-duct" in plain text: "cystic duct".
std::string spoken(std::string name);

/// "0:42.5", "12:03.0": minutes, seconds and tenths, with the decimal point of no locale.
std::string timeText(double seconds);

/// "critical", "major", "minor".
const char* nameOf(Severity severity);

/// Subject and words: "cystic duct left open, cut with too few clips".
std::string textOf(const AttemptError& error, const SubjectNames& names);

/// An error for people.
struct ErrorLine {
  Severity severity = Severity::minor;
  std::uint32_t count = 1;
  double time = 0.0;  ///< of its worst occasion: the end of the step, as of events (s)
  std::string text;   ///< "cystic duct left open"

  [[nodiscard]] std::string counted() const;  ///< "liver slipped in the jaws, 18 times"
};
std::vector<ErrorLine> linesOf(const std::vector<AttemptError>& errors, const SubjectNames& names, double stepSeconds);

/// Lines of one severity with their times, and how many occasions they are.
struct SeverityWords {
  std::uint32_t count = 0;
  std::string lines;  ///< "cystic duct left open, 1:40.2; liver slipped in the jaws, 18 times, worst at 0:31.0"
};
/// @param missing behind the critical ones: what is not assessed, as of notAssessed()
SeverityWords wordsOf(const std::vector<ErrorLine>& lines, Severity severity,
                      const std::vector<std::string>& missing = {});

/// "Not safe: cystic duct left open, 1:40.2." or "No critical error." @param words of the critical ones, with what is
/// not assessed
std::string safetySentence(const SeverityWords& words);

/// The verdict on an attempt, one sentence a severity, the gravest first. @param missing as of notAssessed()
std::vector<std::string> verdictOf(const std::vector<AttemptError>& errors, const SubjectNames& names,
                                   double stepSeconds, const std::vector<std::string>& missing);

/// "2 major errors: gallbladder perforated, 3:12.0; clip lost, 1:02.0.", "No minor error."
std::string severitySentence(Severity severity, const SeverityWords& words);

}  // namespace calot::analytics
