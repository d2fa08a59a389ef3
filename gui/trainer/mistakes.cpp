// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/mistakes.h"

#include <algorithm>
#include <utility>

namespace calot::gui {
namespace {

constexpr double sameMistake = 1.0;  // s

}  // namespace

double Mistake::branchTime(double stepSeconds) const { return std::max(time - goBackBy, stepSeconds); }

MistakeList::MistakeList(SubjectNames names, double stepSeconds)
    : names_(std::move(names)), stepSeconds_(stepSeconds) {}

bool MistakeList::add(std::span<const Event> events) {
  std::vector<std::pair<std::string, Mistake>> found;  // by structure
  for (const Event& event : events) {
    const EventWords* const words = wordsOf(event.kind);
    if (words == nullptr || !words->fault) continue;
    const std::string name = subjectOf(event, names_);
    auto it = std::find_if(found.begin(), found.end(), [&](const auto& entry) { return entry.first == name; });
    if (it == found.end()) {
      const double time = static_cast<double>(event.step + 1) * stepSeconds_;
      it = found.insert(found.end(), {name, {time, false, name.empty() ? "" : name + ": "}});
    } else {
      it->second.text += ", ";
    }
    it->second.text += words->phrase;
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
