// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of a camera's calibration: lenses and places of the cameras from films of the board, then what every device's
// calibration has (calibration.h), then the trocars and the latency.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "recorder/sources/devices/calibration.h"
#include "recorder/sources/devices/camera/camera_device.h"
#include "recorder/sources/devices/camera/lens_calibration.h"
#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/device_script.h"

namespace calot::recorder {

struct RigFit {
  CameraRig rig;
  std::vector<LensFit> lens;  ///< of each camera
  std::string identity;       ///< of live cameras; "camera:film" of films
};

struct RigSettings {
  double printScale = 1.0;
  double readout = 0.0;  ///< of each camera (s); 0: all rows are exposed at once, or it is not known
};

/// From one or two films, each the view of one camera; those of two cameras were taken at the same time.
/// @throws Error: invalid, for the number of films; damaged, for what is in them
RigFit measureRigFromFilms(const std::vector<std::string>& films, const RigSettings& settings);

/// From live cameras. @param step instructs the person, and waits until it is begun
RigFit measureRigLive(const CameraRequest& request, const RigSettings& settings,
                      const std::function<void(const std::string& text)>& step);

/// All that a device on the clock of ticks gives until its end, as a stream; times count from 0.
DeviceScript streamOf(Device& device, TickClock& clock);

/// Puts the trocars, from the stream's phase "trocar", and the latency into a calibration that has a camera. A hand
/// that has no such phase keeps none.
/// @throws Error (damaged) where the shaft was not tilted enough in the phase to say where it passes
void measureTrocars(const DeviceScript& stream, Calibration& calibration);
void measureLatency(const DeviceScript& stream, bool live, Calibration& calibration);

/// The point that the z axes of all poses pass nearest, by least squares.
/// @returns nothing for fewer than 10 poses, or where the axes are nearly parallel
std::optional<Trocar> fitTrocar(std::span<const DeviceSample> samples);

/// "rest=0:5,pivot=5:25,stroke right=25:31"; times in seconds.
/// @throws Error (invalid)
std::vector<DeviceScript::Phase> parsePhases(const std::string& text);
/// The times of the guided steps, of those that end before `seconds`.
std::vector<DeviceScript::Phase> guidedPhases(double seconds);

}  // namespace calot::recorder
