// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/space_mouse.h"

#include <spnav.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr std::int64_t capPeriod = 4'000'000;   // ns from sample to sample
constexpr std::int64_t capRetry = 500'000'000;  // ns
constexpr double capGap = 0.05;                 // s; after a longer one the tip does not leap
constexpr double fullDeflection = 350.0;        // counts of the daemon at its sensitivity of 1
constexpr double capDeadZone = 0.05;
constexpr double capSpeed = 0.06, capRoll = 1.5, capJaw = 1.2;  // m/s, rad/s, rad/s
constexpr double capWidest = 1.2;                               // rad
constexpr double capReach = 0.15;                               // m

// The library holds one connection a process.
std::atomic<bool> taken{false};

double speedOf(double deflection) {
  const double size = std::min(1.0, deflection < 0.0 ? -deflection : deflection);
  if (size <= capDeadZone) return 0.0;
  const double d = (size - capDeadZone) / (1.0 - capDeadZone);
  return deflection < 0.0 ? -d * d : d * d;
}

}  // namespace

SpaceMouse::SpaceMouse(Hand hand, DeviceClock clock) : hand_(hand), clock_(std::move(clock)) {
  if (taken.exchange(true))
    throw Error(ErrorKind::failure, "SpaceMouse: the other hand has it; the daemon tells one from another to nobody");
  mine_ = true;
  if (spnav_open() < 0) {
    taken = false;
    mine_ = false;
    throw Error(ErrorKind::failure, "SpaceMouse: spacenavd does not answer; start it", {Remedy::listDevices});
  }
  there_ = true;
  info_.name = spaceMouseKind.name;
  info_.identity = "spacenav";
  info_.detail = "SpaceMouse by spacenavd";
  DeviceCapabilities& c = info_.capabilities;
  c.hands = 1;
  c.sensedRotations = 1;
  c.sensesGripper = true;
  c.workspace = {Vec3::Constant(-capReach), Vec3::Constant(capReach)};
  c.rate = 250.0;
  c.absolute = false;
  last_ = clock_();
}

SpaceMouse::~SpaceMouse() { close(); }

void SpaceMouse::close() {
  open_ = false;
  if (std::exchange(there_, false)) spnav_close();
  if (std::exchange(mine_, false)) taken = false;
}

/// @returns false where the daemon is gone
bool SpaceMouse::read() {
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
  // The library does not tell that its socket was closed.
  char byte = 0;
  return ::recv(spnav_fd(), &byte, 1, MSG_PEEK | MSG_DONTWAIT) != 0;
}

void SpaceMouse::poll(std::chrono::nanoseconds wait, DeviceInput& out) {
  if (!open_) return;
  std::int64_t now = clock_();
  if (!there_) {
    if (now < nextAttempt_) {
      std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(wait, std::chrono::milliseconds(20)));
      return;
    }
    nextAttempt_ = now + capRetry;
    if (spnav_open() < 0) return;
    there_ = true;
    last_ = now;
    out.events.push_back({DeviceEvent::Kind::connected, now, info_.identity + ": there again"});
  } else if (!std::exchange(greeted_, true)) {
    out.events.push_back({DeviceEvent::Kind::connected, now, info_.identity + ": there"});
  }
  if (now < last_ + capPeriod && wait.count() > 0) {
    std::this_thread::sleep_for(std::min(wait, std::chrono::nanoseconds(last_ + capPeriod - now)));
    now = clock_();
  }
  if (now < last_ + capPeriod) return;
  if (!read()) {
    spnav_close();
    there_ = false;
    deflection_.fill(0.0);
    held_.fill(false);
    nextAttempt_ = now + capRetry;
    out.events.push_back({DeviceEvent::Kind::disconnected, now, info_.identity + ": spacenavd is gone"});
    return;
  }
  const double seconds = std::min(capGap, 1e-9 * static_cast<double>(now - last_));
  last_ = now;
  position_ += seconds * capSpeed * Vec3(speedOf(deflection_[0]), speedOf(deflection_[1]), speedOf(deflection_[2]));
  position_ = position_.cwiseMax(-capReach).cwiseMin(capReach);
  roll_ += seconds * capRoll * speedOf(deflection_[3]);
  const double open = (held_[1] ? 1.0 : 0.0) - (held_[0] ? 1.0 : 0.0);
  jaw_ = std::min(notNegative(jaw_ + seconds * capJaw * open), capWidest);
  DeviceSample sample;
  sample.hostTime = now;
  sample.sequence = sequence_++;
  sample.hand = hand_;
  sample.position = position_;
  sample.orientation = Quat(cosine(0.5 * roll_), 0.0, 0.0, sine(0.5 * roll_));
  sample.gripper = jaw_;
  if (held_[2]) sample.buttons = button::cutPedal | button::fire;
  out.samples.push_back(sample);
}

constinit const DeviceKind spaceMouseKind{
    .name = "spacenav",
    .usage = "spacenav",
    .help = "SpaceMouse by spacenavd; drives one hand",
    .list =
        [] {
          return std::vector<ListedDevice>{
              {"spacenav", "SpaceMouse, where spacenavd runs", true, "1", "3 + roll, jaw, buttons", "250"}};
        },
    .open =
        [](const DeviceRequest& request) {
          if (!request.argument.empty()) request.refuse("nothing stands behind its name");
          return OpenedDevice{std::make_unique<SpaceMouse>(request.hand.value_or(Hand::right)), nullptr};
        },
};

}  // namespace calot::recorder
