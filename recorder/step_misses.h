// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "sim/scene/step_result.h"

namespace calot::recorder {

/// How many steps of a run missed a tolerance, and which (StepResult::misses): never silent.
struct StepMisses {
  std::uint64_t steps = 0;     ///< all that were added
  std::uint64_t any = 0;       ///< of them, with a miss of whatever kind
  std::uint64_t solver = 0;    ///< the linear solve of some body above its tolerance
  std::uint64_t contact = 0;   ///< the contact problem above its tolerance
  std::uint64_t heldBack = 0;  ///< tissue that would have moved faster than it can was held back

  void add(std::uint32_t misses) {
    ++steps;
    any += misses != 0 ? 1U : 0U;
    solver += (misses & miss::solver) != 0 ? 1U : 0U;
    contact += (misses & miss::contact) != 0 ? 1U : 0U;
    heldBack += (misses & miss::speed) != 0 ? 1U : 0U;
  }
  void add(const StepMisses& other) {
    steps += other.steps;
    any += other.any;
    solver += other.solver;
    contact += other.contact;
    heldBack += other.heldBack;
  }
  bool operator==(const StepMisses&) const = default;
};

/// "17 of 2000 steps missed a tolerance (solver 3, contact 14, held back 0)"; empty where none did.
std::string describe(const StepMisses& misses);

}  // namespace calot::recorder
