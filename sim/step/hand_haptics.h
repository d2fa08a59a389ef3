// SPDX-License-Identifier: GPL-3.0-or-later
// Data of the haptic tick for a hand of a scene.
#pragma once

#include <cstddef>

#include "sim/haptics/haptic_tick.h"
#include "sim/scene/model.h"
#include "sim/scene/state.h"

namespace calot {

/// Haptic state of a hand before the first tick.
HapticState initialHaptics(const State& state, std::size_t hand);

/// Takes one tick's sample: the real pose is the sample through workspace and port; held where the sample is no
/// measurement.
void takeSample(const Model& model, std::size_t hand, const InstrumentSample& sample, HapticState& haptics);

/// Limits of a hand's virtual coupling and device, and its port: the wall is at rest where the shaft is at the start.
HapticModel hapticModel(const Model& model, std::size_t hand);

}  // namespace calot
