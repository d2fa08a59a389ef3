// SPDX-License-Identifier: GPL-3.0-or-later
// Results of recorded steps as today's StepResult, whatever version recorded them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "recorder/recording/reader.h"
#include "sim/judgement/judge.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// Translates results of earlier versions, so that judgement and checkpoints read one form alone.
///
/// Version 3 held the procedure as it was judged, not all the facts behind it:
///   uncleared       is to_clear over that of the attempt's first step (0 where the criterion was met from the start);
///   lower_attached  is lower_third_attached, for every connective tissue;
///   covered         is 0 or 1, such that today's rules give the recorded points for two structures: a changed
///                   threshold for "bare" has no effect on these recordings.
/// Events that were judged at their time stay (Judge counts them as they are). Versions 1 and 2 tell nothing of a
/// procedure; versions from 4 on pass unchanged.
class RecordedResults {
 public:
  RecordedResults(const AttemptHeader& header, const SceneDescription& scene);

  /// Today's result of the next step. Valid until the next call. @pre steps come in their order, from the first one on
  const StepResult& of(const RecordedStep& step);
  /// Columns are counted by the header, structures by the scene: do they agree?
  [[nodiscard]] bool fits(const StepResult& result) const {
    return result.organ.size() == organs_ && (!hasConnective_ || result.connective.size() == connective_);
  }

 private:
  std::size_t organs_, connective_;
  bool hasConnective_;
  bool judged_ = false;               ///< version 3, with a procedure
  std::vector<std::size_t> divided_;  ///< vessels, in the procedure's order
  std::vector<double> toClear_;       ///< of the first step, per body of fat (m^3)
  bool clearedFromStart_ = false;
  StepResult translated_;
};

/// Both hands' forces and torques at one tick, as re-simulation gave them: recordings hold them rounded.
struct TickForces {
  std::array<Vec3, handCount> force, torque;
};

/// Feeds observers with a recording's steps and its end, as a run would: they need not know which of both it is. There
/// is no `keyframe` and no `view`.
/// @param results translates those of earlier versions; null: as recorded @param forces of every tick; null: as
/// recorded
/// @throws Error as Recording::step(); (damaged) where `results` is of a scene with other organs or connective tissues
void feedRecorded(Recording& recording, const std::vector<Observer*>& observers, RecordedResults* results = nullptr,
                  const std::vector<TickForces>* forces = nullptr);

/// Judges an attempt from its recorded results, whatever simulation version made them.
class RecordedJudge {
 public:
  /// @throws Error (damaged) where the scene in the recording cannot be read
  explicit RecordedJudge(const AttemptHeader& header, const JudgementRules& rules = {});
  /// @pre steps come in their order, from the first one on
  const Judgement& observe(const RecordedStep& step) { return judge_.observe(results_.of(step)); }

 private:
  RecordedJudge(const AttemptHeader& header, const SceneDescription& scene, const JudgementRules& rules)
      : results_(header, scene), judge_(scene, rules) {}

  RecordedResults results_;
  Judge judge_;
};

}  // namespace calot::recorder
