// SPDX-License-Identifier: GPL-3.0-or-later
// The fixed motions of the contact benchmarks, over the organs of the scene touch-liver.
#pragma once

#include <memory>
#include <vector>

#include "sim/scene/model.h"

namespace calot::bench {

/// The scene touch-liver (case B: 1,489 + 121 tetrahedra asked for), sleeping off.
SceneDescription touchLiver();

/// @throws Error where the scene cannot be built.
std::unique_ptr<const Model> built(SceneDescription scene);

/// Samples of a run, step by step.
struct Motion {
  std::vector<std::vector<TickSamples>> step;
  std::size_t approach = 0;  ///< from this step on, both instruments press
};

/// Both graspers come down from home, the left onto the gallbladder, the right onto the liver; then they slide to and
/// fro along 30 mm of it in 2 s, held `press` deeper than the surface at rest.
Motion pressAndSlide(const SceneDescription& scene, std::size_t steps, double press = 0.005);

/// The liver of touch-liver, with the right hand's port moved to its left side, so that the shaft lies along it from
/// end to end; it is pressed in by half a millimetre a step, down to 5 cm. The left hand stays at home.
struct LaidShaft {
  SceneDescription scene;
  Motion motion;
};
inline constexpr std::size_t laidHand = 1;
LaidShaft shaftLaidAlongLiver();

}  // namespace calot::bench
