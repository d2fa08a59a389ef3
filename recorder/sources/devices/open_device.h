// SPDX-License-Identifier: GPL-3.0-or-later
// The table of devices, and devices by name.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recorder/sources/devices/device.h"

namespace calot::recorder {

/// Every kind of device that this build knows, in the order in which tables show them.
std::span<const DeviceKind* const> deviceKinds();

/// The kind that a name asks for ("gamepad:left one": gamepad), or null.
const DeviceKind* findDeviceKind(std::string_view name);

/// Device names without a window: "gamepad[:NAME], openigtlink[:HOST[:PORT]], scripted:FILE or null".
/// @param last joins the last two: "or", "and"
std::string deviceUsage(std::string_view last = "or");

/// Opens a device by its name, or two by "left=NAME,right=NAME".
/// @param tools of an OpenIGTLink server: left and right, an empty one for none; ignored for others.
/// @throws Error: invalid, for an unknown name, a wrong port, no tool or the same one twice; damaged, for a bad
/// script; failure, for a gamepad that is not there. An OpenIGTLink server need not be there yet.
/// @param calibration of the device, or null; a camera needs one
/// @param hand the one hand that it is to drive, beside another device
OpenedDevice openDevice(const std::string& name, const std::array<std::string, handCount>& tools,
                        const Calibration* calibration = nullptr, std::optional<Hand> hand = std::nullopt);

/// Devices that can be opened, of all kinds.
std::vector<ListedDevice> listDevices();

/// A device that never moves: both hands stay at D's origin, with one sample per millisecond of the tick clock. For
/// measuring the cost of a run, and the simulation without input.
class NullDevice final : public Device {
 public:
  /// @param clock of its samples (ns).
  explicit NullDevice(DeviceClock clock);

  void poll(std::chrono::nanoseconds wait, DeviceInput& out) override;
  [[nodiscard]] bool connected() const override { return open_; }
  void close() override { open_ = false; }

 private:
  std::int64_t next_;  ///< time of the next sample (ns)
  std::uint64_t sequence_ = 0;
  bool open_ = true;
};

extern const DeviceKind nullKind;

/// Two devices, one for each hand: `left=gamepad,right=force:localhost:18950`. Each gives its own hand's samples and
/// shows its own hand's force. It is connected while both are.
class CombinedDevice final : public Device {
 public:
  /// @param device for the left and the right hand; both live in real time, or both on the tick clock
  /// @param tickClock of the combination, or null in real time
  CombinedDevice(std::array<OpenedDevice, handCount> device, std::shared_ptr<TickClock> tickClock);

  void poll(std::chrono::nanoseconds wait, DeviceInput& out) override;
  [[nodiscard]] bool connected() const override;
  [[nodiscard]] bool ended() const override;
  void setOut(Hand hand, const HandStart& start) override;
  void setWrench(Hand hand, const Wrench& wrench) override;
  void close() override;
  [[nodiscard]] std::array<ForceStatistics, handCount> forceStatistics() const override;

 private:
  bool pollOne(std::size_t hand, DeviceInput& out);

  std::array<OpenedDevice, handCount> device_;
  std::shared_ptr<TickClock> tickClock_;
  std::array<bool, handCount> there_{};
};

/// Does this name ask for two devices?
bool isCombination(const std::string& name);

/// Opens both. @param tools as for openDevice() @throws Error as openDevice(), and invalid where a hand is missing, is
/// named twice, or where the two cannot run together.
OpenedDevice openCombination(const std::string& name, const std::array<std::string, handCount>& tools);

}  // namespace calot::recorder
