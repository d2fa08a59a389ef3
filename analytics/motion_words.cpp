// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/motion_words.h"

#include <cassert>
#include <initializer_list>
#include <utility>

#include "recorder/base/dates.h"

namespace calot::analytics {
namespace {

/// Sets `out` to the meaning of a word. @return empty, or the words that there are
template <class T>
std::string choose(T& out, const std::string& word, std::initializer_list<std::pair<const char*, T>> words) {
  std::string known;
  for (const auto& [name, meaning] : words) {
    if (word == name) {
      out = meaning;
      return {};
    }
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  return known + " is wanted";
}

std::string chooseText(std::string& out, const std::string& word, std::initializer_list<const char*> words) {
  std::string known;
  for (const char* name : words) {
    if (word == name) {
      out = word;
      return {};
    }
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  return known + " is wanted";
}

std::string setTask(std::string& task, const std::string& word) {
  if (word.size() > 60) return "1 to 60 characters are wanted";
  for (const char c : word) {
    if (c <= ' ' || c > '~') return "a word without blanks is wanted";
  }
  task = word;
  return {};
}

}  // namespace

std::string declareMotion(MotionDeclaration& d, std::string_view field, const std::string& word) {
  using recorder::Mode, recorder::Outcome;
  if (word.empty()) return {};
  if (field == "task") return setTask(d.task, word);
  if (field == "mode")
    return choose<Mode>(d.mode, word, {{"practice", Mode::practice}, {"assessment", Mode::assessment}});
  if (field == "purpose") return chooseText(d.purpose, word, {"training", "study", "demo"});
  if (field == "handedness") return chooseText(d.handedness, word, {"right", "left", "unknown"});
  if (field == "outcome") {
    return choose<Outcome>(
        d.outcome, word,
        {{"completed", Outcome::completed}, {"abandoned", Outcome::abandoned}, {"stopped", Outcome::stopped}});
  }
  if (field == "start") {
    if (!recorder::isDate(word)) return "2026-01-31T12:00:00Z is wanted";
    d.startUtc = word;
    return {};
  }
  assert(field == "participant");
  if (word.size() > 64) return "longer than 64 characters";
  d.participant = word;
  return {};
}

}  // namespace calot::analytics
