// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/mistakes.h"

#include <algorithm>
#include <utility>

namespace calot::gui {
namespace {

constexpr double sameMistake = 1.0;  // s

/// What is said of the structure, or nothing for what is no mistake.
const char* phraseOf(EventKind kind) {
  switch (kind) {
    case EventKind::clipDropped:
      return "clip dropped";
    case EventKind::clipHalfOn:
      return "clip half on";
    case EventKind::clipOnClip:
      return "clip on another clip";
    case EventKind::clipTooNear:
      return "clip too near to another, a junction or an edge";
    case EventKind::cutThroughClip:
      return "cut through a clip";
    case EventKind::tooFewClips:
      return "cut with too few clips";
    case EventKind::cutOpen:
      return "left open";
    case EventKind::vesselBurned:
      return "burned through";
    case EventKind::vesselTorn:
      return "torn";
    case EventKind::organPerforated:
      return "perforated";
    case EventKind::graspSlip:
      return "slipped in the jaws";
    case EventKind::tissueTear:
      return "torn out of the jaws";
    case EventKind::strandsTorn:
      return "torn instead of burned";
    case EventKind::criticalError:
      return "must be spared";
    default:
      return nullptr;
  }
}

}  // namespace

std::string spoken(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '_' || c == '-'; }, ' ');
  return name;
}

double Mistake::branchTime(double stepSeconds) const { return std::max(time - goBackBy, stepSeconds); }

MistakeList::MistakeList(std::vector<std::string> structures, std::vector<std::string> connective, double stepSeconds)
    : structures_(std::move(structures)), connective_(std::move(connective)), stepSeconds_(stepSeconds) {}

std::string MistakeList::nameOf(const Event& event) const {
  if (event.kind == EventKind::clipDropped) return {};
  const std::vector<std::string>& names = event.kind == EventKind::strandsTorn ? connective_ : structures_;
  return event.subject < names.size() ? spoken(names[event.subject]) : std::string("?");
}

bool MistakeList::add(std::span<const Event> events) {
  std::vector<std::pair<std::string, Mistake>> found;  // by structure
  for (const Event& event : events) {
    const char* const phrase = phraseOf(event.kind);
    if (phrase == nullptr) continue;
    const std::string name = nameOf(event);
    auto it = std::find_if(found.begin(), found.end(), [&](const auto& entry) { return entry.first == name; });
    if (it == found.end()) {
      const double time = static_cast<double>(event.step + 1) * stepSeconds_;
      it = found.insert(found.end(), {name, {time, false, name.empty() ? "" : name + ": "}});
    } else {
      it->second.text += ", ";
    }
    it->second.text += phrase;
    it->second.critical = it->second.critical || event.kind == EventKind::criticalError;
  }
  bool added = false;
  for (auto& [name, mistake] : found) {
    // Tissue slips and tears step after step: that is one mistake.
    bool again = false;
    for (std::size_t i = all_.size(); i-- > 0 && !again;) {
      again = all_[i].text == mistake.text && mistake.time - last_[i] <= sameMistake;
      if (again) last_[i] = mistake.time;
    }
    if (again) continue;
    last_.push_back(mistake.time);
    all_.push_back(std::move(mistake));
    added = true;
  }
  return added;
}

}  // namespace calot::gui
