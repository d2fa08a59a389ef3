// SPDX-License-Identifier: GPL-3.0-or-later
// What an attempt amounts to at a step, as opposed to a step's raw facts: phase, critical view of safety, errors
// (docs/explanation/procedure.md). Judged from StepResult alone, so that recordings of any simulation version can be
// judged anew.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/scene/step_result.h"

namespace calot {

/// Rises when a rule or a threshold below changes: figures that stand on it then have a new version.
inline constexpr std::uint32_t judgementVersion = 1;

/// What an attempt is at. Numbers are stored in recordings before version 4 of StepResult, and in events.
enum class Phase : std::uint8_t { none = 0, identification = 1, clipping = 2, cutting = 3, dissection = 4, done = 5 };

/// Every threshold of grading. None is measured: each is this program's reading of its source.
struct JudgementRules {
  /// Critical view of safety, shares for one point and for two of each criterion. Larger shares make the view easier.
  double clearedOne = 0.35;  ///< fat in the triangle that may be left
  double clearedTwo = 0.10;
  double freedOne = 0.5;  ///< of the bed's lower third that may still be attached
  double freedTwo = 0.05;
  double bareShare = 0.2;   ///< fat close around a vessel that may be left where it counts as bare
  double encloses = 0.999;  ///< share of a vessel between a clip's legs, below which the clip is half on
  /// Of six points: the view is satisfactory from here on (the published doublet view).
  int satisfactory = 5;
};

/// How far the procedure is.
struct ProcedureStatus {
  Phase phase = Phase::none;         ///< phases may recur
  std::uint8_t triangleCleared = 0;  ///< critical view of safety, 0 to 2 each, frozen at the first clip:
  std::uint8_t lowerThirdFreed = 0;
  std::uint8_t twoStructures = 0;
  bool criticalViewFrozen = false;
  double lowerThirdAttached = 0.0;   ///< share of the lower third of the bed
  std::uint32_t errors = 0;          ///< so far
  std::uint32_t criticalErrors = 0;  ///< so far; one fails the attempt

  [[nodiscard]] int criticalView() const { return triangleCleared + lowerThirdFreed + twoStructures; }
};

/// The judgement after a step.
struct Judgement : ProcedureStatus {
  /// The step's events with what is judged of them beside them, as people read them.
  std::vector<Event> events;
};

}  // namespace calot
