// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "recorder/base/spsc_queue.h"
#include "recorder/sources/devices/device.h"

namespace calot::recorder {

/// Polls a device on a thread of its own, so that samples carry the time of their arrival and the loop never waits for
/// a device. Lock-free between the two threads; its queues allocate only where they grow.
class DevicePump {
 public:
  explicit DevicePump(Device& device);
  ~DevicePump();
  DevicePump(const DevicePump&) = delete;
  DevicePump& operator=(const DevicePump&) = delete;

  /// Appends what came in since the last call. One thread.
  void drain(DeviceInput& out);
  /// For the device's motors. The same thread.
  void setWrench(Hand hand, const Wrench& wrench) { commands_.push({hand, wrench}); }
  [[nodiscard]] bool ended() const { return ended_.load(std::memory_order_acquire); }

 private:
  struct Command {
    Hand hand = Hand::right;
    Wrench wrench;
  };
  void run();

  Device& device_;
  SpscQueue<DeviceSample> samples_;
  SpscQueue<DeviceEvent> events_;
  SpscQueue<Command> commands_;
  std::atomic<bool> stop_{false}, ended_{false};
  std::thread thread_;
};

}  // namespace calot::recorder
