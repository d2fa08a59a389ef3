// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/device_pump.h"

#include <utility>

namespace calot::recorder {

DevicePump::DevicePump(Device& device) : device_(device), thread_([this] { run(); }) {}

DevicePump::~DevicePump() {
  stop_ = true;
  thread_.join();
}

void DevicePump::run() {
  // A motor wants its command every millisecond; a device that only speaks is waited for longer.
  const std::chrono::milliseconds wait(device_.info().capabilities.actuated > 0 ? 1 : 20);
  DeviceInput input;
  Command command;
  while (!stop_) {
    while (commands_.pop(command)) device_.setWrench(command.hand, command.wrench);
    device_.poll(wait, input);
    for (DeviceEvent& event : input.events) events_.push(std::move(event));
    for (const DeviceSample& sample : input.samples) samples_.push(sample);
    input.events.clear();
    input.samples.clear();
    if (device_.ended()) ended_.store(true, std::memory_order_release);
  }
}

void DevicePump::drain(DeviceInput& out) {
  DeviceEvent event;
  while (events_.pop(event)) out.events.push_back(std::move(event));
  DeviceSample sample;
  while (samples_.pop(sample)) out.samples.push_back(sample);
}

}  // namespace calot::recorder
