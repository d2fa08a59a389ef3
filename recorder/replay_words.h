// SPDX-License-Identifier: GPL-3.0-or-later
// Words for the verdict of a replay.
#pragma once

#include "recorder/replay.h"

namespace calot::recorder {

inline constexpr const char* wordFor(ReplayVerdict verdict) {
  switch (verdict) {
    case ReplayVerdict::exact:
      return "bit-exact";
    case ReplayVerdict::diverged:
      return "diverged";
    case ReplayVerdict::damaged:
      return "damaged";
    case ReplayVerdict::undecided:
      return "undecided";
    case ReplayVerdict::consistent:
      return "consistent";
  }
  return "";
}

}  // namespace calot::recorder
