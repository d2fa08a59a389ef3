// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/pointer_device.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "recorder/sources/pointing.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr double maxStep = 0.05;  // s; after a longer gap the pointer does not leap
constexpr std::size_t maxName = 64;

}  // namespace

void Pointer::move(const Vec3& way, double reach) { position = Vec3(position + way).cwiseMax(-reach).cwiseMin(reach); }

void Pointer::openJaw(double angle) { jaw = std::min(notNegative(jaw + angle), widestJaw); }

DeviceSample Pointer::sample(Hand hand, std::int64_t now) {
  return {.hostTime = now,
          .sequence = sequence++,
          .hand = hand,
          .position = position,
          .orientation = Quat(cosine(0.5 * roll), 0.0, 0.0, sine(0.5 * roll)),
          .gripper = jaw};
}

double drawn(double& asked, double most) {
  const double now = std::clamp(asked, -most, most);
  asked -= now;
  return now;
}

double speedOf(double deflection, double deadZone) {
  const double size = std::min(1.0, std::abs(deflection));
  if (size <= deadZone) return 0.0;
  const double d = (size - deadZone) / (1.0 - deadZone);
  return std::copysign(d * d, deflection);
}

std::string nameFrom(const char* text) {
  std::string out(text != nullptr ? text : "unknown");
  out.resize(std::min(out.size(), maxName));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < 0x20 || c >= 0x7f; }, '?');
  return out;
}

PointerDevice::PointerDevice(DeviceClock clock, const char* name, double reach) : ReopeningDevice(std::move(clock)) {
  info_.name = name;
  DeviceCapabilities& c = info_.capabilities;
  c.hands = 1;
  c.sensedRotations = 1;
  c.sensesGripper = true;
  c.workspace = {Vec3::Constant(-reach), Vec3::Constant(reach)};
  c.rate = 250.0;
  c.absolute = false;
  last_ = clock_();
}

std::string PointerDevice::connect() {
  const std::string fault = find();
  if (fault.empty()) last_ = clock_();
  // The reason why a lost device is not found again adds nothing to its loss.
  return fault.empty() || loss_.empty() ? fault : loss_;
}

void PointerDevice::read(std::chrono::nanoseconds wait, DeviceInput& out) {
  std::int64_t now = clock_();
  if (now < last_ + period && wait.count() > 0) {
    std::this_thread::sleep_for(std::min(wait, std::chrono::nanoseconds(last_ + period - now)));
    now = clock_();
  }
  if (now < last_ + period) return;
  if (std::string loss = readControls(); !loss.empty()) {
    loss_ = std::move(loss);
    lose(loss_, out);
    return;
  }
  advance(std::min(maxStep, 1e-9 * static_cast<double>(now - last_)), now, out);
  last_ = now;
}

}  // namespace calot::recorder
