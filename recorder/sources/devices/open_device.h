// SPDX-License-Identifier: GPL-3.0-or-later
// The table of devices, and devices by name.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recorder/sources/devices/device_kind.h"

namespace calot::recorder {

/// Every kind of device that this build knows, in the order in which tables show them.
std::span<const DeviceKind* const> deviceKinds();

/// The kind that a name asks for ("gamepad:left one": gamepad), or null.
const DeviceKind* findDeviceKind(std::string_view name);

/// What can be asked for without a window: "gamepad[:NAME], openigtlink[:HOST[:PORT]], scripted:FILE or null".
/// @param last joins the last two: "or", "and"
std::string deviceUsage(std::string_view last = "or");

/// Opens a device by its name, or two by "left=NAME,right=NAME".
/// @param tools of an OpenIGTLink server: left and right, an empty one for none; ignored for others.
/// @throws Error: invalid, for a name that is none, a wrong port, no tool or the same one twice; damaged, for a bad
/// script; failure, for a gamepad that is not there. An OpenIGTLink server need not be there yet.
/// @param calibration of the device, or null; a camera needs one
/// @param hand the one hand that it is to drive, beside another device
OpenedDevice openDevice(const std::string& name, const std::array<std::string, handCount>& tools,
                        const Calibration* calibration = nullptr, std::optional<Hand> hand = std::nullopt);

/// What could be opened, of all kinds.
std::vector<ListedDevice> listDevices();

}  // namespace calot::recorder
