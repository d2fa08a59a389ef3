// SPDX-License-Identifier: GPL-3.0-or-later
// A device that swings the right hand to and fro: an example of a device. As one of Calot's it would stand in
// recorder/sources/devices.
#include <cmath>
#include <memory>

#include "recorder/sources/devices/device.h"
#include "tests/extending/support/examples.h"

namespace calot::recorder {
namespace {

constexpr std::int64_t period = 10'000'000;  // ns between two samples
constexpr double reach = 0.01;               // m
constexpr double angularFrequency = 3.0;     // rad/s

class PendulumDevice final : public Device {
 public:
  explicit PendulumDevice(DeviceClock clock) : Device(std::move(clock)), next_(clock_()) {
    info_.name = pendulumKind.name;
    info_.identity = "pendulum";
    info_.detail = pendulumKind.help;
    info_.operatorKind = OperatorKind::performer;  // nobody acts
    info_.capabilities.rate = 100.0;
    info_.capabilities.realTime = false;
  }

  [[nodiscard]] bool connected() const override { return open_; }
  void close() override { open_ = false; }

  void poll(std::chrono::nanoseconds /*wait*/, DeviceInput& out) override {
    for (; open_ && next_ <= clock_(); next_ += period, ++sequence_) {
      DeviceSample sample;
      sample.hand = Hand::right;
      sample.deviceTime = sample.hostTime = next_;
      sample.sequence = sequence_;
      sample.position = Vec3(reach * std::sin(angularFrequency * 1e-9 * static_cast<double>(next_)), 0.0, 0.0);
      out.samples.push_back(sample);
    }
  }

 private:
  std::int64_t next_;
  std::uint64_t sequence_ = 0;
  bool open_ = true;
};

}  // namespace

const DeviceKind pendulumKind{
    .name = "pendulum",
    .usage = "pendulum",
    .help = "swings the right hand",
    .row = {"pendulum", "swings the right hand", "right", "3", "100"},
    .open =
        [](const DeviceRequest& request) {
          if (!request.argument.empty()) request.refuse("nothing stands behind its name");
          auto ticks = std::make_shared<TickClock>();
          return OpenedDevice{std::make_unique<PendulumDevice>([ticks] { return ticks->now; }), ticks};
        },
};

}  // namespace calot::recorder
