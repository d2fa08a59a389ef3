// SPDX-License-Identifier: GPL-3.0-or-later
// The scenes in which an attempt is run again to learn how far its figures depend on step, mesh and assumed constants.
// Constants have their names in docs/reference/materials.md, and each a way to change it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/scene/description.h"

namespace calot::analytics {

/// The same scene, divided otherwise: so many ticks a step, and `elements` times as many tetrahedra in every organ;
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

struct SceneConstant {
  std::string name;
  /// Times a positive factor, wherever the scene has it. @returns false where the scene has none.
  std::function<bool(SceneDescription&, double)> multiply;
};

const std::vector<SceneConstant>& sceneConstants();

/// Or null.
const SceneConstant* findSceneConstant(std::string_view name);

/// By how much an assumed constant may be off, either way: the share of it by which uncertainty and sensitivity change
/// it. Assumed itself: measured viscosities and strengths of living tissue differ by more, stiffnesses by about as
/// much.
inline constexpr double assumedChange = 0.3;

}  // namespace calot::analytics
