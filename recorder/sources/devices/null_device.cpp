// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/null_device.h"

#include <algorithm>
#include <utility>

namespace calot::recorder {
namespace {
constexpr std::int64_t period = 1'000'000;  // ns
constexpr std::int64_t maxAtOnce = 1000;    // samples; a poll after a long pause does not make up for all of it
}  // namespace

NullDevice::NullDevice(DeviceClock clock) : clock_(std::move(clock)), next_(clock_()) {
  info_.name = nullKind.name;
  info_.identity = "null";
  info_.detail = nullKind.help;
  info_.operatorKind = OperatorKind::performer;
  info_.capabilities.hands = handCount;
  info_.capabilities.sensesGripper = true;
  info_.capabilities.rate = 1000.0;
  info_.capabilities.realTime = false;
}

void NullDevice::poll(std::chrono::nanoseconds, DeviceInput& out) {
  if (!open_) return;
  const std::int64_t now = clock_();
  if (sequence_ == 0) out.events.push_back({DeviceEvent::Kind::connected, now, "null: there"});
  next_ = std::max(next_, now - maxAtOnce * period);
  for (; next_ <= now; next_ += period, ++sequence_) {
    for (const Hand hand : {Hand::left, Hand::right}) {
      DeviceSample sample;
      sample.deviceTime = sample.hostTime = next_;
      sample.sequence = sequence_;
      sample.hand = hand;
      out.samples.push_back(sample);
    }
  }
}

constinit const DeviceKind nullKind{
    .name = "null",
    .usage = "null",
    .help = "never moves",
    .list =
        [] {
          return std::vector<ListedDevice>{{"null", nullKind.help, true, "2", "none", "1000"}};
        },
    .open =
        [](const DeviceRequest& request) {
          if (!request.argument.empty()) request.refuse("nothing stands behind its name");
          auto ticks = std::make_shared<TickClock>();
          return OpenedDevice{std::make_unique<NullDevice>([ticks] { return ticks->now; }), ticks};
        },
};

}  // namespace calot::recorder
