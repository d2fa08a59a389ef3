// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/scene/description.h"
#include "sim/scene/samples.h"

namespace calot {

/// Scene, State and the samples of the steps after it as plain bytes, for programs that link the core alone: the eight
/// characters "CALOTFL2", the scene description, the State's bytes (as saveState() gives them, length first), the
/// number of ticks, then for each tick both hands and the camera.
struct FlatState {
  SceneDescription scene;
  std::vector<std::byte> state;
  std::vector<TickSamples> ticks;
};

std::vector<std::byte> saveFlat(const FlatState& flat);

/// @returns false where the bytes are no flat state; `flat` is then undefined.
bool loadFlat(std::span<const std::byte> bytes, FlatState& flat);

}  // namespace calot
