// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/mouse_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "recorder/sources/devices/evdev_mouse.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr std::int64_t period = 4'000'000;          // ns from sample to sample
constexpr std::int64_t restingPeriod = 20'000'000;  // ns, of the hand that holds
constexpr double maxStep = 0.05;                    // s; after a longer gap the keys do not leap
constexpr double pixel = 0.00015;                   // m
constexpr double notch = 0.003;                     // m
constexpr double keySpeed = 0.03;                   // m/s
constexpr double fastest = 0.5;                     // m/s
constexpr double rollSpeed = 1.5, jawSpeed = 1.8;
constexpr double largestJaw = 1.2;  // rad
constexpr double fineShare = 0.25;
constexpr double leastInside = 0.01;     // m from the port to the tip
constexpr double leastBeforeEye = 0.02;  // m from the endoscope's eye to the tip
const Vec3 reach(0.2, 0.2, 0.2);         // m

/// Takes from what is asked for as much as may be done now.
double drawn(double& asked, double most) {
  const double now = std::clamp(asked, -most, most);
  asked -= now;
  return now;
}

/// Direction and distance of a point.
struct Line {
  Vec3 direction = Vec3::UnitZ();
  double length = 0.0;
};
Line lineFrom(const Vec3& origin, const Vec3& to) {
  const Vec3 way = to - origin;
  const double length = way.norm();
  return {length > 1e-6 ? Vec3(way / length) : Vec3::UnitZ(), length};
}

}  // namespace

MouseDevice::MouseDevice(std::shared_ptr<MouseInput> input, DeviceClock clock)
    : input_(std::move(input)), clock_(std::move(clock)) {
  info_.name = mouseKind.name;
  info_.identity = "mouse";
  info_.detail = mouseKind.help;
  DeviceCapabilities& c = info_.capabilities;
  c.hands = 2;  // both are there; one is moved at a time
  c.sensedRotations = 1;
  c.sensesGripper = true;
  c.workspace = {Vec3(-reach), reach};
  c.rate = 250.0;
  c.absolute = false;
  last_ = clock_();
}

void MouseDevice::advance(Pointer& p, const MouseInput::Wish& wish, double seconds) {
  const auto either = [&](MouseControl more, MouseControl less) {
    return (wish.holds(more) ? 1.0 : 0.0) - (wish.holds(less) ? 1.0 : 0.0);
  };
  const double share = wish.holds(MouseControl::fine) ? fineShare : 1.0;
  const double keys = share * keySpeed * seconds;
  p.right += share * pixel * wish.pixels[0] + keys * either(MouseControl::right, MouseControl::left);
  p.down += share * pixel * wish.pixels[1] + keys * either(MouseControl::down, MouseControl::up);
  p.in += keys * either(MouseControl::in, MouseControl::out);
  p.away += share * notch * wish.notches;
  const double most = fastest * seconds;
  const Vec3& port = wish.port[static_cast<std::size_t>(wish.hand)];
  const auto [shaft, length] = lineFrom(port, p.position);
  const double right = drawn(p.right, most);
  const double down = drawn(p.down, most);
  const double in = std::max(drawn(p.in, most), notPositive(leastInside - length));
  p.position += Vec3(right, down, 0.0) + in * shaft;
  const auto [sight, distance] = lineFrom(wish.eye[static_cast<std::size_t>(wish.hand)], p.position);
  const double away = std::max(drawn(p.away, most), notPositive(leastBeforeEye - distance));
  const Vec3 seen = p.position + away * sight;
  // Towards the eye may be towards the port, too.
  const double inside = (seen - port).norm();
  if (inside >= leastInside || inside >= (p.position - port).norm()) p.position = seen;
  p.position = p.position.cwiseMax(-reach).cwiseMin(reach);
  p.roll += share * rollSpeed * seconds * either(MouseControl::rollRight, MouseControl::rollLeft);
  p.jaw =
      std::min(notNegative(p.jaw + share * jawSpeed * seconds * either(MouseControl::openJaw, MouseControl::closeJaw)),
               largestJaw);
}

void MouseDevice::put(Hand hand, const MouseInput::Wish& wish, std::uint8_t momentary, std::int64_t now,
                      DeviceInput& out) {
  Pointer& p = pointer_[static_cast<std::size_t>(hand)];
  DeviceSample sample;
  sample.hostTime = now;
  sample.sequence = p.sequence++;
  sample.hand = hand;
  sample.position = p.position;
  sample.orientation = Quat(cosine(0.5 * p.roll), 0.0, 0.0, sine(0.5 * p.roll));
  sample.gripper = p.jaw;
  sample.buttons = momentary;
  if (wish.locked[static_cast<std::size_t>(hand)])
    sample.buttons = static_cast<std::uint8_t>(sample.buttons | button::lock);
  out.samples.push_back(sample);
}

void MouseDevice::poll(std::chrono::nanoseconds wait, DeviceInput& out) {
  if (!open_) return;
  std::int64_t now = clock_();
  if (!greeted_) {
    greeted_ = true;
    out.events.push_back({DeviceEvent::Kind::connected, now, "mouse and keyboard: there"});
    const MouseInput::Wish wish = input_->take();
    for (const Hand hand : {Hand::left, Hand::right}) put(hand, wish, 0, now, out);
    last_ = lastResting_ = now;
    return;
  }
  if (now < last_ + period && wait.count() > 0) {
    std::this_thread::sleep_for(std::min(wait, std::chrono::nanoseconds(last_ + period - now)));
    now = clock_();
  }
  if (now < last_ + period) return;
  const MouseInput::Wish wish = input_->take();
  const Hand other = wish.hand == Hand::right ? Hand::left : Hand::right;
  Pointer& resting = pointer_[static_cast<std::size_t>(other)];
  resting.right = resting.down = resting.in = resting.away = 0.0;
  advance(pointer_[static_cast<std::size_t>(wish.hand)], wish,
          std::min(maxStep, 1e-9 * static_cast<double>(now - last_)));
  std::uint8_t momentary = 0;
  const auto bit = [&](MouseControl control, std::uint8_t mask) {
    if (wish.holds(control)) momentary = static_cast<std::uint8_t>(momentary | mask);
  };
  bit(MouseControl::cut, button::cutPedal);
  bit(MouseControl::coagulate, button::coagulatePedal);
  bit(MouseControl::fire, button::fire);
  put(wish.hand, wish, momentary, now, out);
  last_ = now;
  // At once where it has just been left.
  if (wish.hand == hand_ && now < lastResting_ + restingPeriod) return;
  hand_ = wish.hand;
  lastResting_ = now;
  put(other, wish, 0, now, out);
}

constinit const DeviceKind mouseKind{
    .name = "mouse",
    .usage = "mouse",
    .help = "mouse and keyboard of the trainer's window",
    .needsWindow = true,
    .list =
        [] {
          std::vector<ListedDevice> out{{"mouse", "needs a window: calot-trainer has one", false, "2, 1 at a time",
                                         "3 + roll, jaw, buttons", "250"}};
          const std::vector<ListedMouse> mice = listMice();
          for (std::size_t i = 0; i < mice.size(); ++i)
            out.push_back({fmt::format("mouse:{}", i), mice[i].name + ", taken from the system's pointer", true, "1",
                           "3 + roll, jaw, buttons", "250"});
          return out;
        },
    .open = [](const DeviceRequest& request) -> OpenedDevice {
      if (!request.argument.empty())
        return {std::make_unique<EvdevMouse>(request.argument, request.hand.value_or(Hand::right)), nullptr};
      request.refuse("mouse and keyboard need a window: calot-trainer has one");
    },
};

}  // namespace calot::recorder
