// SPDX-License-Identifier: GPL-3.0-or-later
// Texts for events and errors, shared by films, the dashboard's lists, the trainer and the page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analytics/checkpoints/error_words.h"
#include "sim/judgement/judge.h"

namespace calot::gui {

using analytics::spoken;
using analytics::SubjectNames;
using analytics::timeText;

/// Text for a kind of event that is a plain fact: "cystic duct: clip set" is the subject's name and the phrase.
struct EventWords {
  enum class Subject { none, structure, connective };
  EventKind kind;
  Subject subject;     ///< whose name precedes the phrase
  const char* phrase;  ///< "clip set"
};

/// Null for technical events (contacts, samples, solver, smoke).
[[nodiscard]] const EventWords* wordsOf(EventKind kind);

/// Subject and phrase; empty where wordsOf() is null. The subject is "tissue" or "connective tissue" where no name is
/// known.
[[nodiscard]] std::string textOf(const Event& event, const SubjectNames& names);

/// An event or an error of a step, in words.
struct Told {
  Event event;                       ///< the fact, or the one by which the rule was broken
  std::optional<Severity> severity;  ///< of an error
  std::string text;                  ///< "cystic duct: clip set", "cystic duct left open, cut with too few clips"
  std::string title;                 ///< what it is listed under: "clip set"; of an error its text

  /// It should not have happened: an error, or a simulation that failed.
  [[nodiscard]] bool marked() const { return severity.has_value() || event.kind == EventKind::runaway; }
};

/// Errors of the step, those of one structure in one sentence, and its other facts that have words.
[[nodiscard]] std::vector<Told> tell(const Judgement& judgement, const SubjectNames& names);

/// "identification", ..., "done"; empty for none.
[[nodiscard]] std::string wordFor(Phase phase);

}  // namespace calot::gui
