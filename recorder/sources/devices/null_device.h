// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/device_kind.h"

namespace calot::recorder {

/// A device that never moves: both hands stay at D's origin, with one sample per millisecond of the tick clock. For
/// measuring the cost of a run, and the simulation without input.
class NullDevice final : public Device {
 public:
  /// @param clock of its samples (ns).
  explicit NullDevice(DeviceClock clock);

  [[nodiscard]] const DeviceInfo& info() const override { return info_; }
  void poll(std::chrono::nanoseconds wait, DeviceInput& out) override;
  [[nodiscard]] bool connected() const override { return open_; }
  void close() override { open_ = false; }

 private:
  DeviceInfo info_;
  DeviceClock clock_;
  std::int64_t next_;  ///< time of the next sample (ns)
  std::uint64_t sequence_ = 0;
  bool open_ = true;
};

extern const DeviceKind nullKind;

}  // namespace calot::recorder
