// SPDX-License-Identifier: GPL-3.0-or-later
// Events that a trainee may want to undo.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gui/words/event_words.h"

namespace calot::gui {

/// So long before a mistake a branch sets out (s).
inline constexpr double goBackBy = 2.0;

/// What went wrong in one step with one structure, or again and again within a second.
struct Mistake {
  double time = 0.0;      ///< of the attempt, when it first happened (s)
  bool critical = false;  ///< fails an assessment
  std::string text;       ///< one line: "cystic duct: clip half on"

  /// Where the branch leaves (s): goBackBy earlier, or the end of the first step.
  [[nodiscard]] double branchTime(double stepSeconds) const;
};

/// The mistakes of an attempt in the order of time: all events that should not happen (EventWords::fault).
class MistakeList {
 public:
  MistakeList(SubjectNames names, double stepSeconds);

  /// The events of one step. @returns whether something was added
  bool add(std::span<const Event> events);

  [[nodiscard]] const std::vector<Mistake>& all() const { return all_; }

 private:
  SubjectNames names_;
  double stepSeconds_;
  std::vector<Mistake> all_;
  std::vector<double> last_;  ///< per mistake, when it last happened (s)
};

}  // namespace calot::gui
