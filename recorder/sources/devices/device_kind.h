// SPDX-License-Identifier: GPL-3.0-or-later
// Declaration of a kind of device. Each device's own source file defines its DeviceKind; the table in open_device.cpp
// lists them. Help texts, `calot devices`, `--device` and the trainer's menu use that table.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recorder/sources/devices/device.h"

namespace calot::recorder {

struct Calibration;

/// The clock of a device without real time: a tick is a millisecond of it.
struct TickClock {
  std::int64_t now = 0;  ///< ns
};

/// A user's request for a device.
struct DeviceRequest {
  std::string name;      ///< as written: "openigtlink:localhost:18944"
  std::string argument;  ///< behind the first colon, never empty where there is a colon: "localhost:18944"
  std::array<std::string, handCount> tools;  ///< names of a tracker's tools, left and right; empty: none
  const Calibration* calibration = nullptr;  ///< of the device, where one was given: a camera's lens is in it
  std::optional<Hand> hand = std::nullopt;   ///< the one hand that it is to drive, beside another device

  /// @throws Error (invalid) that names the request and says why
  [[noreturn]] void refuse(const std::string& why) const;
};

struct OpenedDevice {
  std::unique_ptr<Device> device;
  std::shared_ptr<TickClock> tickClock;  ///< for devices without real time: DeviceSourceSettings::tickClock
};

/// One row of `calot devices`.
struct ListedDevice {
  std::string name;    ///< what to ask for
  std::string detail;  ///< for people
  bool present = true;
  std::string hands;
  std::string senses;
  std::string rate;
};

struct DeviceKind {
  const char* name;          ///< before the colon, and DeviceInfo::name: "gamepad"; stored, never reused
  const char* usage;         ///< how to ask for one: "gamepad[:NAME]"
  const char* help;          ///< one line for people
  bool needsWindow = false;  ///< its input comes from a window, which opens it; `open` refuses
  /// Lists devices that are, or could be, available. Does not throw.
  std::vector<ListedDevice> (*list)();
  /// @throws Error: invalid, for a request that makes no sense; damaged, for a bad file; failure, where it is not
  /// there.
  OpenedDevice (*open)(const DeviceRequest& request);
};

}  // namespace calot::recorder
