// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/words/event_words.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "analytics/checkpoints/phases.h"

namespace calot::gui {
namespace {

using Subject = EventWords::Subject;

constexpr std::array<EventWords, 26> told{{
    {EventKind::instrumentExchange, Subject::none, "instrument exchanged", false},
    {EventKind::instrumentsTouched, Subject::none, "instruments touched", false},
    {EventKind::retractionMore, Subject::structure, "more retraction asked for", false},
    {EventKind::retractionLess, Subject::structure, "less retraction asked for", false},
    {EventKind::graspSlip, Subject::structure, "slipped in the jaws", true},
    {EventKind::tissueTear, Subject::structure, "torn out of the jaws", true},
    {EventKind::strandsTorn, Subject::connective, "torn instead of burned", true},
    {EventKind::fatTorn, Subject::structure, "thin string tore", false},
    {EventKind::connectiveFreed, Subject::connective, "divided", false},
    {EventKind::vesselTorn, Subject::structure, "torn", true},
    {EventKind::clipSet, Subject::structure, "clip set", false},
    {EventKind::clipHalfOn, Subject::structure, "clip half on", true},
    {EventKind::clipOnClip, Subject::structure, "clip on another clip", true},
    {EventKind::clipTooNear, Subject::structure, "clip too near to another, a junction or an edge", true},
    {EventKind::clipDropped, Subject::none, "clip dropped", true},
    {EventKind::vesselCut, Subject::structure, "cut", false},
    {EventKind::cutOpen, Subject::structure, "left open", true},
    {EventKind::cutThroughClip, Subject::structure, "cut through a clip", true},
    {EventKind::vesselBurned, Subject::structure, "burned through", true},
    {EventKind::wallInjured, Subject::structure, "wall injured by heat", true},
    {EventKind::vesselSealed, Subject::structure, "sealed", false},
    {EventKind::organPerforated, Subject::structure, "perforated", true},
    {EventKind::tooFewClips, Subject::structure, "cut with too few clips", true},
    {EventKind::criticalError, Subject::structure, "harmed though it must be spared", true},
    {EventKind::clockStretched, Subject::none, "simulation late, clock stretched", false},
    {EventKind::runaway, Subject::none, "simulation failed", true},
}};

}  // namespace

const EventWords* wordsOf(EventKind kind) {
  const auto* const found =
      std::find_if(told.begin(), told.end(), [kind](const EventWords& words) { return words.kind == kind; });
  return found == told.end() ? nullptr : found;
}

std::string subjectOf(const Event& event, const SubjectNames& names) {
  const EventWords* const words = wordsOf(event.kind);
  if (words == nullptr || words->subject == Subject::none) return {};
  const bool structure = words->subject == Subject::structure;
  const std::vector<std::string>& name = structure ? names.structures : names.connective;
  if (event.subject < name.size()) return spoken(name[event.subject]);
  return structure ? "tissue" : "connective tissue";
}

std::string textOf(const Event& event, const SubjectNames& names) {
  const EventWords* const words = wordsOf(event.kind);
  if (words == nullptr) return {};
  const std::string subject = subjectOf(event, names);
  return subject.empty() ? words->phrase : subject + ": " + words->phrase;
}

std::string spoken(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '_' || c == '-'; }, ' ');
  return name;
}

std::string timeText(double seconds) {
  const auto tenths = static_cast<long long>(std::floor(std::max(0.0, seconds) * 10.0 + 1e-6));
  const long long rest = tenths / 10 % 60;
  return std::to_string(tenths / 600) + (rest < 10 ? ":0" : ":") + std::to_string(rest) + '.' +
         std::to_string(tenths % 10);
}

std::string wordFor(Phase phase) {
  if (phase == Phase::none) return {};
  return phase == Phase::done ? "done" : analytics::nameOf(phase);
}

}  // namespace calot::gui
