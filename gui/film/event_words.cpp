// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/event_words.h"

#include <fmt/format.h>

namespace calot::gui {

std::string wordsFor(const Event& event, const std::vector<std::string>& structures) {
  const std::string subject = event.subject < structures.size() ? structures[event.subject] : "tissue";
  switch (event.kind) {
    case EventKind::graspSlip:
      return subject + " slips";
    case EventKind::tissueTear:
      return subject + " torn out of the jaws";
    case EventKind::strandsTorn:
      return "connective tissue torn";
    case EventKind::connectiveFreed:
      return "connective tissue divided";
    case EventKind::vesselTorn:
      return subject + " torn";
    case EventKind::clipSet:
      return "clip on " + subject;
    case EventKind::clipHalfOn:
      return "clip does not enclose " + subject;
    case EventKind::clipOnClip:
      return "clip on a clip";
    case EventKind::clipTooNear:
      return "clip too near";
    case EventKind::clipDropped:
      return "clip dropped";
    case EventKind::vesselCut:
      return subject + " cut";
    case EventKind::cutOpen:
      return subject + " is open";
    case EventKind::cutThroughClip:
      return "cut through a clip";
    case EventKind::vesselBurned:
      return subject + " burned through";
    case EventKind::organPerforated:
      return subject + " perforated";
    case EventKind::tooFewClips:
      return fmt::format("too few clips on {}", subject);
    case EventKind::criticalError:
      return "critical error: " + subject;
    default:
      return "";
  }
}

bool isFault(EventKind kind) {
  switch (kind) {
    case EventKind::graspSlip:
    case EventKind::tissueTear:
    case EventKind::strandsTorn:
    case EventKind::vesselTorn:
    case EventKind::clipHalfOn:
    case EventKind::clipOnClip:
    case EventKind::clipTooNear:
    case EventKind::clipDropped:
    case EventKind::cutOpen:
    case EventKind::cutThroughClip:
    case EventKind::vesselBurned:
    case EventKind::organPerforated:
    case EventKind::tooFewClips:
    case EventKind::criticalError:
      return true;
    default:
      return false;
  }
}

}  // namespace calot::gui
