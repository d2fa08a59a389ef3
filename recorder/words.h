// SPDX-License-Identifier: GPL-3.0-or-later
// Words for the recording's enumerations. Stored spellings are those of recording/layout.h.
#pragma once

#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"

namespace calot::recorder {

inline constexpr const char* wordFor(OperatorKind kind) {
  switch (kind) {
    case OperatorKind::human:
      return "human";
    case OperatorKind::kinematics:
      return "kinematics";
    case OperatorKind::performer:
      return "performer";
  }
  return "unknown";
}

inline constexpr const char* wordFor(Mode mode) {
  switch (mode) {
    case Mode::practice:
      return "practice";
    case Mode::assessment:
      return "assessment";
  }
  return "unknown";
}

inline constexpr const char* wordFor(Outcome outcome) {
  switch (outcome) {
    case Outcome::running:
      return "running";
    case Outcome::completed:
      return "completed";
    case Outcome::timeLimit:
      return "time limit";
    case Outcome::abandoned:
      return "abandoned";
    case Outcome::stopped:
      return "stopped";
    case Outcome::technicalFailure:
      return "technical failure";
  }
  return "unknown";
}

}  // namespace calot::recorder
