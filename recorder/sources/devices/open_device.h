// SPDX-License-Identifier: GPL-3.0-or-later
// Devices by name: gamepad[:NAME], openigtlink[:HOST[:PORT]], null, scripted:FILE.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/device_source.h"

namespace calot::recorder {

struct OpenedDevice {
  std::unique_ptr<Device> device;
  std::shared_ptr<TickClock> tickClock;  ///< for devices without real time: DeviceSourceSettings::tickClock
};

/// Opens a device by its name.
/// @param tools of an OpenIGTLink server: left and right, an empty one for none; ignored for others.
/// @throws Error: usage, for a name that is none, a wrong port, no tool or the same one twice; damaged, for a bad
/// script; failure, for a gamepad that is not there. An OpenIGTLink server need not be there yet.
OpenedDevice openDevice(const std::string& name, const std::array<std::string, handCount>& tools);

/// What could be opened, for `calot devices`.
struct ListedDevice {
  std::string name;    ///< for --device
  std::string detail;  ///< for people
  bool present = true;
  std::string hands;
  std::string senses;
  std::string rate;
};
std::vector<ListedDevice> listDevices();

}  // namespace calot::recorder
