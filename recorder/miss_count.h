// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "recorder/engine/observer.h"
#include "recorder/step_misses.h"

namespace calot::recorder {

/// Counts the steps of a run that missed a tolerance.
class MissCount final : public Observer {
 public:
  void onStep(const StepRecord& record) override { misses.add(record.result.misses); }
  void onEnd(Outcome /*outcome*/) override {}
  StepMisses misses;
};

}  // namespace calot::recorder
