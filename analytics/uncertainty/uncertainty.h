// SPDX-License-Identifier: GPL-3.0-or-later
// Error bars of a recording's figures: the same hands in smaller steps, with a finer mesh and with other constants.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/uncertainty/value_interval.h"
#include "recorder/loop.h"

namespace calot::analytics {

/// What an attempt's hands do in a scene.
struct OpenLoopRun {
  std::vector<CheckpointValue> values;
  std::uint64_t tetrahedra = 0;  ///< of all organs
};

/// On the caller's thread. @param header of the recording; its division into steps is the scene's
OpenLoopRun runIn(const Model& model, const recorder::AttemptHeader& header, const recorder::AttemptInputs& inputs);

/// @throws Error (refused) with `what` where the scene cannot be built.
OpenLoopRun runIn(const SceneDescription& scene, const recorder::AttemptHeader& header,
                  const recorder::AttemptInputs& inputs, const std::string& what);

/// Called by any of the threads, one at a time, when a run has ended.
using UncertaintyProgress = std::function<void(std::uint64_t done, std::uint64_t of)>;

/// Runs an attempt's samples in half the step (to the next whole tick), with twice the tetrahedra, and
/// in twelve scenes with perturbed constants (scene_variants.h); each run by itself, `threads` at a time.
/// @param values of the attempt as it is: those that the intervals are of
/// @param threads 0: one for each processor
/// @throws Error (refused) where the attempt's scene cannot be varied: steps of one tick
std::vector<ValueInterval> estimateUncertainty(const SceneDescription& scene, const recorder::AttemptHeader& header,
                                               const recorder::AttemptInputs& inputs,
                                               const std::vector<CheckpointValue>& values, unsigned threads,
                                               const UncertaintyProgress& progress = {});

/// The same of a recording. @throws Error as Recording does, too.
std::vector<ValueInterval> estimateUncertainty(const std::filesystem::path& recording,
                                               const std::vector<CheckpointValue>& values, unsigned threads,
                                               const UncertaintyProgress& progress = {});

}  // namespace calot::analytics
