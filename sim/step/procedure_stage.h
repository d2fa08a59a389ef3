// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 10 of a step: what the step did, as a step of the procedure (docs/procedure.md).
#pragma once

#include <vector>

#include "sim/scene/state.h"
#include "sim/step/bodies.h"
#include "sim/step/step_log.h"

namespace calot {

/// Phase, critical view of safety and errors. Nothing else of a step depends on them.
///
/// Reads: the result and the events of the stages before, what is left of fat, bed and vessels. Writes: State's
/// procedure and StepResult's; phaseBegin and criticalError events.
class ProcedureStage {
 public:
  /// @param bodies whose fat is uncarved yet
  ProcedureStage(const Model& model, const Bodies& bodies);
  void run(const Bodies& bodies, State& state, StepResult& result, StepLog& log) const;

 private:
  [[nodiscard]] double fatLeftIn(const Bodies& bodies, std::size_t region) const;
  [[nodiscard]] double lowerThirdAttached(const State& state) const;
  [[nodiscard]] bool isParted(const State& state, std::size_t structure) const;
  void judgeView(const Bodies& bodies, const State& state, ProcedureState& procedure) const;
  void countEvent(const Event& event, ProcedureState& procedure, Phase& phase, StepLog& log) const;

  const Model& model_;
  std::vector<double> wholeRegion_;  ///< of the procedure's fat: volumes of its regions before anything is carved (m^3)
  std::vector<std::size_t> divided_;  ///< structures that are to be divided
};

}  // namespace calot
