// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "recorder/sources/devices/device_kind.h"

namespace calot::recorder {

/// Two devices, one for each hand: `left=gamepad,right=force:localhost:18950`. Each gives its own hand's samples and
/// shows its own hand's force. It is connected while both are.
class CombinedDevice final : public Device {
 public:
  /// @param device for the left and the right hand; both live in real time, or both on the tick clock
  /// @param tickClock of the combination, or null in real time
  CombinedDevice(std::array<OpenedDevice, handCount> device, std::shared_ptr<TickClock> tickClock);

  [[nodiscard]] const DeviceInfo& info() const override { return info_; }
  void poll(std::chrono::nanoseconds wait, DeviceInput& out) override;
  [[nodiscard]] bool connected() const override;
  [[nodiscard]] bool ended() const override;
  void setWrench(Hand hand, const Wrench& wrench) override;
  void close() override;
  [[nodiscard]] std::vector<std::string> report() const override;

 private:
  bool pollOne(std::size_t hand, DeviceInput& out);

  std::array<OpenedDevice, handCount> device_;
  std::shared_ptr<TickClock> tickClock_;
  DeviceInfo info_;
  std::array<bool, handCount> there_{};
};

/// Does this name ask for two devices?
bool isCombination(const std::string& name);

/// Opens both. @param tools as for openDevice() @throws Error as openDevice(), and invalid where a hand is missing, is
/// named twice, or where the two cannot run together.
OpenedDevice openCombination(const std::string& name, const std::array<std::string, handCount>& tools);

}  // namespace calot::recorder
