// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/step_misses.h"

#include <fmt/format.h>

namespace calot::recorder {

std::string describe(const StepMisses& misses) {
  if (misses.any == 0) return {};
  return fmt::format("{} of {} steps missed a tolerance (solver {}, contact {}, held back {})", misses.any,
                     misses.steps, misses.solver, misses.contact, misses.heldBack);
}

}  // namespace calot::recorder
