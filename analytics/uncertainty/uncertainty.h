// SPDX-License-Identifier: GPL-3.0-or-later
// Error bars of a recording's figures: the same hands in smaller steps, with a finer mesh and with other constants.
// Constants have their names in docs/reference/materials.md, and each a way to change it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/uncertainty/value_interval.h"
#include "recorder/loop.h"
#include "sim/scene/description.h"

namespace calot::analytics {

/// Motion of an attempt's hands in a scene.
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
/// in twelve scenes with perturbed constants (perturbed()); each run by itself, `threads` at a time.
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

/// The same scene, divided otherwise: `ticksPerStep`, and `elements` times as many tetrahedra in every organ;
/// with them fat's cubes, the vessels' elements and the strands of beds, each by the same ratio of lengths
/// (elements^(1/3)), rounded to whole ones.
SceneDescription redivided(const SceneDescription& scene, std::uint32_t ticksPerStep, double elements);

/// Assumed constants that are changed together, in the direction in which they add up.
struct AssumedFactor {
  std::string name;                    ///< "bed stiffness", for people
  std::vector<std::string> constants;  ///< names of sceneConstants(), times 1 +- assumedChange
  std::vector<std::string> inverse;    ///< of those, divided by it
};

/// Runs of the screening design, and the factors that it can tell apart.
inline constexpr std::size_t designRuns = 12;
inline constexpr std::size_t designFactors = 11;
const std::array<AssumedFactor, designFactors>& assumedFactors();

/// +1 or -1: whether the factor is raised or lowered in a run. Orthogonal in columns: the design of Plackett and Burman
/// (Biometrika 33 (1946) 305) with twelve runs, which gives the main effect of eleven factors each from all twelve.
int designSign(std::size_t run, std::size_t factor);

/// The scene in which a run of the design takes place.
SceneDescription perturbed(const SceneDescription& scene, std::size_t run);

/// A constant by the names of the fields that lead to it; of lists by the name of a part, or * for each of them.
struct SceneConstant {
  std::string name;  ///< "vessels.*.material.youngModulus"
  /// Times a positive factor, wherever the scene has it. @returns false where the scene has none, or 0
  bool multiply(SceneDescription& scene, double factor) const;
};

const std::vector<SceneConstant>& sceneConstants();

/// Or null.
const SceneConstant* findSceneConstant(std::string_view name);

/// By how much an assumed constant may be off, either way: the share of it by which uncertainty and sensitivity change
/// it. Assumed itself: measured viscosities and strengths of living tissue differ by more, stiffnesses by about as
/// much.
inline constexpr double assumedChange = 0.3;

}  // namespace calot::analytics
