// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sim/judgement/judgement.h"
#include "sim/scene/description.h"

namespace calot {

/// Judges an attempt step by step. Live panel, hints, performers, replay, assessment and regrading all use this; it
/// obeys the determinism contract, sees StepResult alone, and nothing of it is State.
///
/// Recordings before version 4 of StepResult hold what was judged of clips and cuts at their time as events of their
/// own; where the facts behind them are missing, those count as they were recorded.
class Judge {
 public:
  /// @param scene the attempt's own: what its procedure wants
  explicit Judge(const SceneDescription& scene, const JudgementRules& rules = {});

  /// Judges the next step. @pre results come in the order of steps, from the attempt's first one on
  const Judgement& observe(const StepResult& result);

  /// After the last observed step; before the first, the phase in which the procedure begins.
  [[nodiscard]] const Judgement& judgement() const { return now_; }
  [[nodiscard]] const JudgementRules& rules() const { return rules_; }

 private:
  /// A vessel that is to be divided.
  struct Divide {
    std::size_t vessel = 0;              ///< of the scene's
    std::size_t structure = 0;           ///< of the scene's
    std::array<std::size_t, 2> clips{};  ///< wanted towards its start and towards its end
  };

  /// Are there results of all that the procedure names? Not before version 3 of StepResult.
  [[nodiscard]] bool isReported(const StepResult& result) const;
  [[nodiscard]] bool isToDivide(std::size_t structure) const;
  [[nodiscard]] bool isParted(const StepResult& result, std::size_t vessel) const;
  void judgeView(const StepResult& result);
  void judgeClip(const std::vector<Event>& events, std::size_t at);
  void judgeCut(const std::vector<Event>& events, std::size_t at);
  void countEvent(const std::vector<Event>& events, std::size_t at, Phase& phase);
  void countError(Event event, EventKind kind, double value);

  JudgementRules rules_;
  ClipDescription clip_;
  bool present_ = false;  ///< the scene has a procedure
  bool hasFat_ = false;
  bool hasBed_ = false;
  std::size_t fat_ = 0;  ///< the procedure's body of fat
  std::size_t bed_ = 0;  ///< the procedure's connective tissue
  std::vector<Divide> divide_;
  std::vector<std::size_t> spare_;  ///< structures
  Judgement now_;
};

}  // namespace calot
