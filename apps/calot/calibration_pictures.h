// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "recorder/sources/devices/camera/camera_calibration.h"

namespace calot::apps {

/// Writes DIR/camera-N.png of each camera: where the board was seen, and as arrows, enlarged fifty times, how far each
/// corner was from where the lens has it.
/// @throws Error (failure)
void writeCalibrationPictures(const recorder::RigFit& fit, const std::filesystem::path& folder);

}  // namespace calot::apps
