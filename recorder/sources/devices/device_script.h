// SPDX-License-Identifier: GPL-3.0-or-later
// A stream of device samples as a file, which a scripted device plays or a calibration is measured
// from (format in docs/how-to/devices.md).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "recorder/sources/devices/device.h"

namespace calot::recorder {

struct DeviceScript {
  /// A labelled time interval for a calibration: rest, pivot, stroke x, stroke y, stroke z.
  struct Phase {
    std::string name;
    std::int64_t from = 0, to = 0;  ///< ns
  };
  /// The device is gone in [at, at + length).
  struct Unplugging {
    std::int64_t at = 0, length = 0;  ///< ns
  };

  std::string name;                   ///< of the device that made it, or that it stands for
  std::string file, sha256;           ///< base name, and of its bytes
  bool motionFile = false;            ///< read from the kinematics text format
  double rate = 0.0;                  ///< nominal (1/s); 0: unknown
  double maxForce = 0.0;              ///< N; above 0 the scripted device has motors
  std::vector<DeviceSample> samples;  ///< hostTime from 0, not falling
  std::vector<Unplugging> unpluggings;
  std::vector<Phase> phases;
};

/// Reads a script: JSON where the text begins with "{", else two-handed kinematics (kinematics_file.h), row
/// i at i/30 s.
/// @throws Error (damaged) with file and place.
DeviceScript readDeviceScript(const std::filesystem::path& file);
DeviceScript parseDeviceScript(std::span<const std::byte> bytes, const std::string& file);

/// The JSON text of a script; parseDeviceScript gives the same samples and phases back.
std::string deviceScriptText(const DeviceScript& script);

}  // namespace calot::recorder
