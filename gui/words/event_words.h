// SPDX-License-Identifier: GPL-3.0-or-later
// Texts for events, shared by films, the dashboard's lists and the trainer's list of mistakes.
#pragma once

#include <string>
#include <vector>

#include "sim/judgement/judge.h"

namespace calot::gui {

/// Text for a kind of event: "cystic duct: clip half on" is the subject's name and the phrase.
struct EventWords {
  enum class Subject { none, structure, connective };
  EventKind kind;
  Subject subject;     ///< whose name precedes the phrase
  const char* phrase;  ///< "clip half on"
  bool fault;          ///< a mistake, harm, or a simulation failure
};

/// Null for technical events (contacts, samples, solver, smoke).
[[nodiscard]] const EventWords* wordsOf(EventKind kind);

/// Names in the order of event subject indices.
struct SubjectNames {
  std::vector<std::string> structures;
  std::vector<std::string> connective;  ///< connective tissues; may be left empty
};

/// The subject's name in plain text: "cystic duct". Empty if the phrase stands alone; "tissue" or "connective tissue"
/// if no name is known.
[[nodiscard]] std::string subjectOf(const Event& event, const SubjectNames& names);

/// Subject and phrase; empty where wordsOf() is null.
[[nodiscard]] std::string textOf(const Event& event, const SubjectNames& names);

/// "cystic-duct" in plain text: "cystic duct".
[[nodiscard]] std::string spoken(std::string name);

/// "0:42.5", "12:03.0": minutes, seconds and tenths, with the decimal point of no locale.
[[nodiscard]] std::string timeText(double seconds);

/// "identification", ..., "done"; empty for none.
[[nodiscard]] std::string wordFor(Phase phase);

}  // namespace calot::gui
