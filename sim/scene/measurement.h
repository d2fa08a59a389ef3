// SPDX-License-Identifier: GPL-3.0-or-later
// Validity of a hand's measurement, and the real pose that it gives, for the step and the haptic tick alike.
#pragma once

#include "sim/scene/description.h"
#include "sim/scene/samples.h"

namespace calot {

/// Valid, finite, and with an orientation that can be normalised.
bool isMeasurement(const InstrumentSample& sample);
bool isMeasurement(const CameraSample& sample);

/// A tip held inside the scene's workspace (m, W).
Vec3 clampedToWorkspace(const SceneDescription& scene, const Vec3& tip);

/// Direction from the port to a tip, unit; straight down where they coincide.
Vec3 axisOf(const Vec3& port, const Vec3& tip);

/// The real instrument of a measurement: orientation normalised, tip held inside the workspace, through the port.
/// @param previousTip gives the axis where the tip is at the port. @pre isMeasurement(sample)
Pose realPose(const SceneDescription& scene, std::size_t hand, const InstrumentSample& sample, const Vec3& previousTip);

}  // namespace calot
