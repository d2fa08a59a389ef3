// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "sim/judgement/judge.h"

namespace calot::recorder {

/// /observables/procedure of recordings in version 3 of StepResult, in which the simulation judged the procedure.
struct RecordedProcedure {
  Phase phase = Phase::none;
  std::uint8_t triangleCleared = 0, lowerThirdFreed = 0, twoStructures = 0;
  bool criticalViewFrozen = false;
  double lowerThirdAttached = 0.0;
  std::uint32_t errors = 0, criticalErrors = 0;
  bool operator==(const RecordedProcedure&) const = default;
};

}  // namespace calot::recorder
