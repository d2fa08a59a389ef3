// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "recorder/sources/devices/calibration.h"

namespace calot::recorder {

/// Of a mouse nothing can be measured: its counts are exact, and how far the hand moves for one is the system's
/// setting. Whoever sets the station up says it. Rate and intervals are the device's by its making.
/// @param pixel how far the hand moves for a pixel (m)
/// @throws Error (invalid) for a device of another class, or a length that is none of a mouse
Calibration declaredCalibration(const DeviceInfo& device, double pixel);

}  // namespace calot::recorder
