// SPDX-License-Identifier: GPL-3.0-or-later
// The examples of docs/extending that are C++: what stands in Calot's own tables for its own.
#pragma once

#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "recorder/sources/devices/device.h"
#include "sim/instruments/instruments.h"

namespace calot {

namespace analytics {
std::vector<CheckpointEntry> longestTouchRows();
}
namespace recorder {
extern const DeviceKind pendulumKind;
}
namespace instrument {
extern const InstrumentDefinition palpator;
}

}  // namespace calot
