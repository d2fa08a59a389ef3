// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/pointer_device.h"

#include <sys/socket.h>
#include <atomic>
#include <utility>

#include "recorder/base/errors.h"

#include <spnav.h>  // after Eigen: X11's header has macros

namespace calot::recorder {
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

OpenedDevice openSpaceMouse(const DeviceRequest& request) {
  if (!request.argument.empty()) request.refuse("nothing stands behind its name");
  return {std::make_unique<SpaceMouse>(request.hand.value_or(Hand::right)), nullptr};
}

}  // namespace calot::recorder
