// SPDX-License-Identifier: GPL-3.0-or-later
// calot devices calibrate: what a device measures like.
// The steps that a person is guided through on a terminal while a device is measured.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "apps/calot/command.h"
#include "recorder/sources/devices/camera/camera_calibration.h"
#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/device_script.h"

namespace calot::apps {

/// Adds the command below `devices`. @returns it @param run is set to it where it was asked for
CLI::App* addCalibrateDevice(CLI::App& devices, Run& run);

/// Writes DIR/camera-N.png of each camera: where the board was seen, and as arrows, enlarged fifty times, how far each
/// corner was from where the lens has it.
/// @throws Error (failure)
void writeCalibrationPictures(const recorder::RigFit& fit, const std::filesystem::path& folder);

/// @throws Error (invalid) where nobody could be guided
void requireTerminal();

/// Tells what to do, and waits until the person is ready. @throws Error (failure) where the person breaks off
void promptStep(const std::string& text);

/// Measurements of the device while the person did the steps of its kind. @throws Error as above, and (failure) where
/// no sample came
recorder::DeviceScript guidedSteps(recorder::Device& device, double strokeMillimetres);

}  // namespace calot::apps
