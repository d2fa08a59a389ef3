// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/words/event_words.h"

#include <algorithm>
#include <array>

#include "analytics/checkpoints/phases.h"

namespace calot::gui {
namespace {

using Subject = EventWords::Subject;

constexpr std::array<EventWords, 21> told{{
    {EventKind::instrumentExchange, Subject::none, "instrument exchanged"},
    {EventKind::instrumentsTouched, Subject::none, "instruments touched"},
    {EventKind::retractionMore, Subject::structure, "more retraction asked for"},
    {EventKind::retractionLess, Subject::structure, "less retraction asked for"},
    {EventKind::graspSlip, Subject::structure, "slipped in the jaws"},
    {EventKind::tissueTear, Subject::structure, "torn out of the jaws"},
    {EventKind::strandsTorn, Subject::connective, "torn"},
    {EventKind::fatTorn, Subject::structure, "thin string tore"},
    {EventKind::connectiveFreed, Subject::connective, "divided"},
    {EventKind::vesselTorn, Subject::structure, "torn"},
    {EventKind::clipSet, Subject::structure, "clip set"},
    {EventKind::vesselCut, Subject::structure, "cut"},
    {EventKind::cutOpen, Subject::structure, "open end"},
    {EventKind::vesselBurned, Subject::structure, "burned through"},
    {EventKind::wallInjured, Subject::structure, "wall burned"},
    {EventKind::vesselSealed, Subject::structure, "sealed"},
    {EventKind::organPerforated, Subject::structure, "perforated"},
    {EventKind::pressedHard, Subject::structure, "pressed hard"},
    {EventKind::clipDropped, Subject::none, "clip lost"},
    {EventKind::clockStretched, Subject::none, "simulation late, clock stretched"},
    {EventKind::runaway, Subject::none, "simulation failed"},
}};

std::string subjectOf(const Event& event, const EventWords& words, const SubjectNames& names) {
  if (words.subject == Subject::none) return {};
  const bool structure = words.subject == Subject::structure;
  const std::vector<std::string>& name = structure ? names.structures : names.connective;
  if (event.subject < name.size()) return spoken(name[event.subject]);
  return structure ? "tissue" : "connective tissue";
}

}  // namespace

const EventWords* wordsOf(EventKind kind) {
  const auto* const found =
      std::find_if(told.begin(), told.end(), [kind](const EventWords& words) { return words.kind == kind; });
  return found == told.end() ? nullptr : found;
}

std::string textOf(const Event& event, const SubjectNames& names) {
  const EventWords* const words = wordsOf(event.kind);
  if (words == nullptr) return {};
  const std::string subject = subjectOf(event, *words, names);
  return subject.empty() ? words->phrase : subject + ": " + words->phrase;
}

std::vector<Told> tell(const Judgement& judgement, const SubjectNames& names) {
  std::vector<Told> told;
  ErrorList errors;
  errors.add(judgement.found);
  for (const AttemptError& error : errors.all()) {
    const std::string text = analytics::textOf(error, names);
    const auto by = std::find_if(judgement.found.begin(), judgement.found.end(), [&](const JudgedError& e) {
      return e.rule == error.rules.front() && e.event.subject == error.subject;
    });
    told.push_back({by->event, error.severity(), text, text});
  }
  for (const Event& event : judgement.events) {
    const EventWords* const words = wordsOf(event.kind);
    const bool isError = std::any_of(judgement.found.begin(), judgement.found.end(), [&](const JudgedError& e) {
      return e.event.kind == event.kind && e.event.subject == event.subject && e.event.hand == event.hand;
    });
    if (words != nullptr && !isError) told.push_back({event, {}, textOf(event, names), words->phrase});
  }
  return told;
}

std::string wordFor(Phase phase) {
  if (phase == Phase::none) return {};
  return phase == Phase::done ? "done" : analytics::nameOf(phase);
}

}  // namespace calot::gui
