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
class ForceDevice final : public ForceFeedbackDevice {
 public:
  /// @throws Error (failure) where nothing answers, or what answers is no force device of this version.
  explicit ForceDevice(ForceDeviceSettings settings, DeviceClock clock = monotonicNanoseconds);
  ~ForceDevice() override { close(); }

  [[nodiscard]] bool connected() const override { return stream_.open(); }

 private:
  std::string connect() override;
  void disconnect() override { stream_.close(); }
  void read(std::chrono::nanoseconds wait, DeviceInput& out) override;
  void sayGoodbye() override { stream_.send(forcewire::encode(forcewire::End{})); }
  void take(const forcewire::Pose& pose, DeviceInput& out);

  ForceDeviceSettings settings_;
  TcpStream stream_;
  forcewire::Decoder decoder_;
  std::vector<forcewire::Frame> frames_;
  std::optional<forcewire::Hello> hello_;
  std::array<std::uint64_t, handCount> sequence_{};
  bool toldInvalid_ = false;
};

extern const DeviceKind forceKind;

}  // namespace calot::recorder
