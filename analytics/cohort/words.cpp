// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/words.h"

namespace calot::analytics {

std::string wordFor(recorder::OperatorKind kind) {
  switch (kind) {
    case recorder::OperatorKind::human:
      return "human";
    case recorder::OperatorKind::kinematics:
      return "kinematics";
    case recorder::OperatorKind::performer:
      return "performer";
  }
  return "unknown";
}

std::string wordFor(recorder::Mode mode) {
  switch (mode) {
    case recorder::Mode::practice:
      return "practice";
    case recorder::Mode::assessment:
      return "assessment";
  }
  return "unknown";
}

std::string wordFor(recorder::Outcome outcome) {
  switch (outcome) {
    case recorder::Outcome::running:
      return "running";
    case recorder::Outcome::completed:
      return "completed";
    case recorder::Outcome::timeLimit:
      return "time limit";
    case recorder::Outcome::abandoned:
      return "abandoned";
    case recorder::Outcome::stopped:
      return "stopped";
    case recorder::Outcome::technicalFailure:
      return "technical failure";
  }
  return "unknown";
}

}  // namespace calot::analytics
