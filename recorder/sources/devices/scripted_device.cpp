// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/sources/devices/scripted_device.h"

#include <algorithm>
#include <utility>

namespace calot::recorder {
namespace {

Vec3 clamped(const Vec3& v, double longest) {
  if (!v.allFinite()) return Vec3::Zero();
  const double largest = v.cwiseAbs().maxCoeff();
  if (largest == 0.0) return v;
  // In two steps, as the square of a huge number overflows.
  const Vec3 unit = (v / largest).normalized();
  const double length = largest * (v / largest).norm();
  return length > longest ? Vec3(longest * unit) : v;
}

}  // namespace

void WrenchGate::command(const Wrench& wrench, std::int64_t now) {
  wrench_ = {clamped(wrench.force, force_), clamped(wrench.torque, torque_)};
  commanded_ = now;
  any_ = true;
}

Wrench WrenchGate::output(std::int64_t now) const {
  if (!any_ || now - commanded_ >= watchdog) return {};
  return wrench_;
}

ScriptedDevice::ScriptedDevice(DeviceScript script, DeviceClock clock)
    : Device(std::move(clock)),
      script_(std::move(script)),
      gate_{WrenchGate(script_.maxForce, 0.0), WrenchGate(script_.maxForce, 0.0)},
      origin_(clock_()) {
  std::sort(script_.unpluggings.begin(), script_.unpluggings.end(),
            [](const auto& a, const auto& b) { return a.at < b.at; });
  info_.name = scriptedKind.name;
  info_.identity = "scripted:" + script_.name;
  info_.detail = "plays " + script_.file;
  info_.operatorKind = script_.motionFile ? OperatorKind::kinematics : OperatorKind::performer;
  info_.sourceFile = script_.file;
  info_.sourceSha256 = script_.sha256;
  std::array<bool, handCount> hand{};
  for (const DeviceSample& s : script_.samples) hand[static_cast<std::size_t>(s.hand)] = true;
  info_.capabilities.hands = static_cast<int>(hand[0]) + static_cast<int>(hand[1]);
  info_.capabilities.sensesGripper = true;
  info_.capabilities.actuated = script_.maxForce > 0.0 ? 3 : 0;
  info_.capabilities.maxForce = script_.maxForce;
  info_.capabilities.rate = script_.rate;
  info_.capabilities.realTime = false;
}

void ScriptedDevice::poll(std::chrono::nanoseconds, DeviceInput& out) {
  if (!open_) return;
  const std::int64_t now = clock_();
  if (!greeted_) {
    greeted_ = connected_ = true;
    tell(DeviceEvent::Kind::connected, info_.identity + ": there", out);
  }
  for (;;) {
    const bool more = unplugging_ < script_.unpluggings.size();
    const std::int64_t gone = more ? origin_ + script_.unpluggings[unplugging_].at : now + 1;
    const std::int64_t back = more ? gone + script_.unpluggings[unplugging_].length : gone;
    const std::int64_t until = std::min(now, gone - 1);
    for (; next_ < script_.samples.size() && origin_ + script_.samples[next_].hostTime <= until; ++next_) {
      out.samples.push_back(script_.samples[next_]);
      out.samples.back().hostTime += origin_;
    }
    if (now < gone) return;
    if (connected_) {
      connected_ = false;
      out.events.push_back({DeviceEvent::Kind::disconnected, gone, info_.identity + ": unplugged"});
    }
    if (now < back) return;
    origin_ += script_.unpluggings[unplugging_].length;
    ++unplugging_;
    connected_ = true;
    out.events.push_back({DeviceEvent::Kind::connected, back, info_.identity + ": there again"});
  }
}

void ScriptedDevice::setWrench(Hand hand, const Wrench& wrench) {
  gate_[static_cast<std::size_t>(hand)].command(wrench, clock_());
}

Wrench ScriptedDevice::shown(Hand hand) const {
  if (!connected_) return {};
  return gate_[static_cast<std::size_t>(hand)].output(clock_());
}

constinit const DeviceKind scriptedKind{
    .name = "scripted",
    .usage = "scripted:FILE",
    .help = "plays a script or a kinematics file",
    .row = {"scripted:FILE", "plays a script or a kinematics file", "2", "6, jaw, buttons", "the file's"},
    .open =
        [](const DeviceRequest& request) {
          if (request.argument.empty()) request.refuse("a file is missing: scripted:FILE");
          auto ticks = std::make_shared<TickClock>();
          return OpenedDevice{
              std::make_unique<ScriptedDevice>(readDeviceScript(request.argument), [ticks] { return ticks->now; }),
              ticks};
        },
};

}  // namespace calot::recorder
