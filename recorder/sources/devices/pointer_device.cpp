// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/pointer_device.h"

#include <spnav.h>
#include <sys/socket.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"
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

namespace {

constexpr double fullDeflection = 350.0;  // counts of the daemon at its sensitivity of 1
constexpr double capDeadZone = 0.05;
constexpr double capSpeed = 0.06, capRoll = 1.5, capJaw = 1.2;  // m/s, rad/s, rad/s
constexpr double capReach = 0.15;                               // m

// The library holds one connection a process.
std::atomic<bool> taken{false};

}  // namespace

SpaceMouse::SpaceMouse(Hand hand, DeviceClock clock)
    : PointerDevice(std::move(clock), spaceMouseKind.name, capReach), hand_(hand) {
  if (taken.exchange(true))
    throw Error(ErrorKind::failure, "SpaceMouse: the other hand has it; the daemon tells one from another to nobody");
  mine_ = true;
  try {
    connectFirst("SpaceMouse");
  } catch (...) {
    taken = false;
    throw;
  }
  info_.identity = "spacenav";
  info_.detail = "SpaceMouse by spacenavd";
}

SpaceMouse::~SpaceMouse() { SpaceMouse::close(); }

void SpaceMouse::close() {
  PointerDevice::close();
  if (std::exchange(mine_, false)) taken = false;
}

std::string SpaceMouse::find() {
  there_ = spnav_open() >= 0;
  return there_ ? "" : "spacenavd does not answer; start it";
}

void SpaceMouse::disconnect() {
  if (std::exchange(there_, false)) spnav_close();
  deflection_.fill(0.0);
  held_.fill(false);
}

std::string SpaceMouse::readControls() {
  spnav_event event;
  while (spnav_poll_event(&event) != 0) {
    if (event.type == SPNAV_EVENT_MOTION) {
      // The daemon's axes: x right, y up, z away.
      const auto& m = event.motion;
      deflection_ = {m.x / fullDeflection, -m.y / fullDeflection, m.z / fullDeflection, m.rz / fullDeflection};
    } else if (event.type == SPNAV_EVENT_BUTTON && event.button.bnum >= 0 &&
               event.button.bnum < static_cast<int>(held_.size())) {
      held_[static_cast<std::size_t>(event.button.bnum)] = event.button.press != 0;
    }
  }
  // The library does not report that its socket was closed.
  char byte = 0;
  return ::recv(spnav_fd(), &byte, 1, MSG_PEEK | MSG_DONTWAIT) != 0 ? "" : "spacenavd is gone";
}

void SpaceMouse::advance(double seconds, std::int64_t now, DeviceInput& out) {
  const auto speed = [this](std::size_t axis) { return speedOf(deflection_[axis], capDeadZone); };
  pointer_.move(seconds * capSpeed * Vec3(speed(0), speed(1), speed(2)), capReach);
  pointer_.roll += seconds * capRoll * speed(3);
  pointer_.openJaw(seconds * capJaw * between(held_[1], held_[0]));
  DeviceSample& sample = out.samples.emplace_back(pointer_.sample(hand_, now));
  press(sample.buttons, held_[2], button::cutPedal | button::fire);
}

constinit const DeviceKind spaceMouseKind{
    .name = "spacenav",
    .usage = "spacenav",
    .help = "SpaceMouse by spacenavd; drives one hand",
    .row = {"spacenav", "SpaceMouse, where spacenavd runs", "1", "3 + roll, jaw, buttons", "250"},
    .open =
        [](const DeviceRequest& request) {
          if (!request.argument.empty()) request.refuse("nothing stands behind its name");
          return OpenedDevice{std::make_unique<SpaceMouse>(request.hand.value_or(Hand::right)), nullptr};
        },
};

}  // namespace calot::recorder
