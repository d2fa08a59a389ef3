// SPDX-License-Identifier: GPL-3.0-or-later
// When keyframes are taken: so that simulating from one of them to any step takes no longer where steps are hard than
// where they are easy. Internal to this folder.
#pragma once

#include <cstddef>
#include <cstdint>

#include "recorder/recording/layout.h"
#include "sim/scene/step_result.h"

namespace calot::recorder {

/// Goes by what a step reports of its own work, never by clocks: the same attempt has the same keyframes everywhere.
class KeyframeSchedule {
 public:
  explicit KeyframeSchedule(const Layout& layout, double tickSeconds);

  /// Takes the next step. @return whether a keyframe is due after it: only at the end of a block.
  bool dueAfter(const StepResult& result);

  /// A keyframe was taken. @param stateBytes of its State; the first one's is the measure of the scene's size.
  void taken(std::size_t stateBytes);

 private:
  std::uint64_t stepsPerBlock_;
  std::uint64_t longest_;  ///< steps: about a second, whole blocks
  std::uint64_t steps_ = 0;
  std::uint64_t since_ = 0;  ///< steps since the last keyframe
  double work_ = 0.0;        ///< since the last keyframe (ms)
  double blockWork_ = 0.0;   ///< of the block so far (ms)
  double size_ = 0.0;        ///< of the scene, as a multiple of the one that the work was measured in; 0: not yet known
};

}  // namespace calot::recorder
