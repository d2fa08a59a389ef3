// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/force/force_output.h"
#include "recorder/sources/devices/force/force_wire.h"
#include "recorder/sources/devices/tcp.h"

namespace calot::recorder {

struct ForceDeviceSettings {
  std::string host = "localhost";
  int port = forcewire::defaultPort;
  std::uint8_t hands = 3;  ///< that are wanted: bit 0 left, bit 1 right
};

/// Host's side of the protocol of force devices (schemas/device.md). Every pose is a sample, and is followed by one
/// wrench, which ForceOutput makes of the simulation's.
///
/// Connects while it is made, since the device says there what it can do; connects again after a loss, every half
/// second, to the same device alone.
class ForceDevice final : public Device {
 public:
  /// @throws Error (failure) where nothing answers, or what answers is no force device of this version.
  explicit ForceDevice(ForceDeviceSettings settings, DeviceClock clock = monotonicNanoseconds);
  ~ForceDevice() override;

  [[nodiscard]] const DeviceInfo& info() const override { return info_; }
  void poll(std::chrono::nanoseconds wait, DeviceInput& out) override;
  [[nodiscard]] bool connected() const override { return stream_.open(); }
  void setWrench(Hand hand, const Wrench& wrench) override;
  /// Lets the force fall to zero first, for at most a fifth of a second.
  void close() override;
  [[nodiscard]] std::vector<std::string> report() const override { return reports_.lines(); }

 private:
  /// @returns what is wrong, or an empty text
  std::string connect();
  void reconnect(DeviceInput& out);
  void lose(const std::string& why, DeviceInput& out);
  void take(const forcewire::Pose& pose, DeviceInput& out);
  void receive(DeviceInput& out);

  ForceDeviceSettings settings_;
  DeviceInfo info_;
  DeviceClock clock_;
  TcpStream stream_;
  forcewire::Decoder decoder_;
  std::vector<forcewire::Frame> frames_;
  std::optional<forcewire::Hello> hello_;
  std::array<std::optional<ForceOutput>, handCount> output_;
  std::array<std::uint64_t, handCount> sequence_{};
  std::int64_t nextAttempt_ = 0;
  std::string refusal_;
  bool open_ = true, greeted_ = false, toldInvalid_ = false;
  ForceReports reports_;
};

extern const DeviceKind forceKind;

}  // namespace calot::recorder
