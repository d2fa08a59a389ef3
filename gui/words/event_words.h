// SPDX-License-Identifier: GPL-3.0-or-later
// What people read of events: films, the dashboard's lists and the trainer's mistakes say the same of the same.
#pragma once

#include <string>
#include <vector>

#include "sim/judgement/judgement.h"

namespace calot::gui {

/// How a kind of event is told: "cystic duct: clip half on" is its subject's name and its phrase.
struct EventWords {
  enum class Subject { none, structure, connective };
  EventKind kind;
  Subject subject;     ///< whose name stands before the phrase
  const char* phrase;  ///< "clip half on"
  bool fault;          ///< something that should not happen: a mistake, harm done, or a simulation that failed
};

/// Null for events that only a machine cares for (contacts, samples, solver, smoke).
[[nodiscard]] const EventWords* wordsOf(EventKind kind);

/// Names as subjects of events count.
struct SubjectNames {
  std::vector<std::string> structures;
  std::vector<std::string> connective;  ///< connective tissues; may be left empty
};

/// The subject as people write it: "cystic duct". Empty where the phrase stands alone; "tissue" or "connective tissue"
/// where no name is known.
[[nodiscard]] std::string subjectOf(const Event& event, const SubjectNames& names);

/// Subject and phrase; empty where wordsOf() is null.
[[nodiscard]] std::string textOf(const Event& event, const SubjectNames& names);

/// "cystic-duct" as people write it.
[[nodiscard]] std::string spoken(std::string name);

/// "identification", ..., "done"; empty for none.
[[nodiscard]] std::string wordFor(Phase phase);

}  // namespace calot::gui
