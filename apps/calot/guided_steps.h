// SPDX-License-Identifier: GPL-3.0-or-later
// The steps that a person is guided through on a terminal while a device is measured.
#pragma once

#include <string>

#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/device_script.h"

namespace calot::apps {

/// @throws Error (invalid) where nobody could be guided
void requireTerminal();

/// Tells what to do, and waits until the person is ready. @throws Error (failure) where the person breaks off
void promptStep(const std::string& text);

/// What the device gave while the person did the steps that its kind needs. @throws Error as above, and (failure) where
/// no sample came
recorder::DeviceScript guidedSteps(recorder::Device& device, double strokeMillimetres);

}  // namespace calot::apps
