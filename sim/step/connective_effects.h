// SPDX-License-Identifier: GPL-3.0-or-later
// What a step does to connective tissue. Internal to this folder.
#pragma once

#include <vector>

#include "sim/step/bodies.h"
#include "sim/step/hook_touches.h"
#include "sim/step/step_log.h"

namespace calot {

/// Burns the strands that the energised hooks touch; damages and tears those that are pulled too hard.
class ConnectiveEffects {
 public:
  explicit ConnectiveEffects(const Model& model) : model_(model) {}

  /// @pre organs and instruments are where the step leads them
  void run(const HookSweeps& sweeps, const std::array<HookTouches, handCount>& touches, Bodies& bodies, State& state,
           Activity& activity, StepResult& result, StepLog& log);

 private:
  const Model& model_;
  std::vector<std::uint32_t> strands_;
};

}  // namespace calot
