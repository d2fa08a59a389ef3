// SPDX-License-Identifier: GPL-3.0-or-later
// One performer's samples, open-loop, in a scene that differs from the one they were performed in, and every checkpoint
// of that.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "sim/scene/description.h"
#include "sim/scene/samples.h"

namespace calot::analytics {

/// A value by checkpoint and subject.
using Values = std::map<std::string, CheckpointValue>;

struct Graded {
  Values values;
  std::size_t tetrahedra = 0;
};

/// A shipped scene.
SceneDescription sceneOf(const std::string& scene);

/// What the skilled performer (seed 1) does in a shipped scene, until it is done or for so many seconds.
std::vector<TickSamples> performedTicks(const std::string& scene, double seconds);

/// Runs whole steps of the samples in the scene, on the caller's thread. @param name of the run, in failures
Graded graded(const std::string& name, const SceneDescription& scene, const std::vector<TickSamples>& ticks);

}  // namespace calot::analytics
