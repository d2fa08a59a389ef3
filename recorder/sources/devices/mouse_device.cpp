// SPDX-License-Identifier: GPL-3.0-or-later
// The kernel's interface itself (linux/input.h): a reader of relative axes and buttons is shorter than a library's
// set-up, and takes events from any stream, which tests without a mouse need.
#include "recorder/sources/devices/mouse_device.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <map>
#include <utility>

#include "recorder/sources/devices/evdev.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr std::int64_t restingPeriod = 20'000'000;  // ns, of the hand that holds
constexpr double pixel = 0.00015;                   // m, also of a count
constexpr double notch = 0.003;                     // m
constexpr double tilt = 0.1;                        // rad, of a tilting wheel's notch
constexpr double keySpeed = 0.03;                   // m/s
constexpr double fastest = 0.5;                     // m/s
constexpr double rollSpeed = 1.5, jawSpeed = 1.8;   // rad/s
constexpr double fineShare = 0.25;
constexpr double leastInside = 0.01;              // m from the port to the tip
constexpr double leastBeforeEye = 0.02;           // m from the endoscope's eye to the tip
constexpr double reach = 0.2, evdevReach = 0.15;  // m

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
    : PointerDevice(std::move(clock), mouseKind.name, reach), input_(std::move(input)) {
  info_.identity = "mouse";
  info_.detail = mouseKind.help;
  info_.capabilities.hands = 2;  // both are there; one is moved at a time
}

std::string MouseDevice::find() {
  there_ = true;
  return readControls();  // motion from before is dropped
}

std::string MouseDevice::readControls() {
  wish_ = input_->take();
  return {};
}

void MouseDevice::setOut(Hand hand, const HandStart& start) {
  PointerDevice::setOut(hand, start);
  input_->setLock(hand, start.locked);
}

void MouseDevice::move(Pointer& p, double seconds) {
  const auto either = [&](MouseControl more, MouseControl less) {
    return between(wish_.holds(more), wish_.holds(less));
  };
  const double share = wish_.holds(MouseControl::fine) ? fineShare : 1.0;
  const double keys = share * keySpeed * seconds;
  asked_.right += share * pixel * wish_.pixels[0] + keys * either(MouseControl::right, MouseControl::left);
  asked_.down += share * pixel * wish_.pixels[1] + keys * either(MouseControl::down, MouseControl::up);
  asked_.in += keys * either(MouseControl::in, MouseControl::out);
  asked_.away += share * notch * wish_.notches;
  const double most = fastest * seconds;
  const Vec3& port = wish_.port[static_cast<std::size_t>(wish_.hand)];
  const auto [shaft, length] = lineFrom(port, p.position);
  const double right = drawn(asked_.right, most);
  const double down = drawn(asked_.down, most);
  const double in = std::max(drawn(asked_.in, most), notPositive(leastInside - length));
  p.position += Vec3(right, down, 0.0) + in * shaft;
  const auto [sight, distance] = lineFrom(wish_.eye[static_cast<std::size_t>(wish_.hand)], p.position);
  const double away = std::max(drawn(asked_.away, most), notPositive(leastBeforeEye - distance));
  const Vec3 seen = p.position + away * sight;
  // Towards the eye may be towards the port, too.
  const double inside = (seen - port).norm();
  if (inside >= leastInside || inside >= (p.position - port).norm()) p.position = seen;
  p.move(Vec3::Zero(), reach);
  p.roll += share * rollSpeed * seconds * either(MouseControl::rollRight, MouseControl::rollLeft);
  p.openJaw(share * jawSpeed * seconds * either(MouseControl::openJaw, MouseControl::closeJaw));
}

void MouseDevice::put(Hand hand, std::uint8_t momentary, std::int64_t now, DeviceInput& out) {
  DeviceSample& sample = out.samples.emplace_back(pointer_[static_cast<std::size_t>(hand)].sample(hand, now));
  sample.buttons = momentary;
  press(sample.buttons, wish_.locked[static_cast<std::size_t>(hand)], button::lock);
}

void MouseDevice::advance(double seconds, std::int64_t now, DeviceInput& out) {
  const bool left = wish_.hand != hand_;
  if (left) asked_ = {};
  hand_ = wish_.hand;
  move(pointer_[static_cast<std::size_t>(hand_)], seconds);
  std::uint8_t momentary = 0;
  press(momentary, wish_.holds(MouseControl::cut), button::cutPedal);
  press(momentary, wish_.holds(MouseControl::coagulate), button::coagulatePedal);
  press(momentary, wish_.holds(MouseControl::fire), button::fire);
  put(hand_, momentary, now, out);
  // The hand that holds: at once where it has just been left.
  if (!left && now < lastResting_ + restingPeriod) return;
  lastResting_ = now;
  put(hand_ == Hand::right ? Hand::left : Hand::right, 0, now, out);
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

namespace {

bool hasBit(const std::array<unsigned char, KEY_MAX / 8 + 1>& bits, unsigned bit) {
  return (bits[bit / 8] & (1U << (bit % 8))) != 0;
}

std::string nameOf(int descriptor) {
  std::array<char, 128> text{};
  return ::ioctl(descriptor, EVIOCGNAME(text.size() - 1), text.data()) < 0 ? "mouse" : nameFrom(text.data());
}

bool isMouse(int descriptor) {
  std::array<unsigned char, KEY_MAX / 8 + 1> axes{}, keys{};
  if (::ioctl(descriptor, EVIOCGBIT(EV_REL, axes.size()), axes.data()) < 0) return false;
  if (::ioctl(descriptor, EVIOCGBIT(EV_KEY, keys.size()), keys.data()) < 0) return false;
  return hasBit(axes, REL_X) && hasBit(axes, REL_Y) && hasBit(keys, BTN_LEFT);
}

Descriptor openFile(const std::filesystem::path& path) {
  return Descriptor(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
}

}  // namespace

std::vector<ListedMouse> listMice() {
  std::map<int, ListedMouse> found;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/input", ignored)) {
    const std::string file = entry.path().filename().string();
    if (!file.starts_with("event")) continue;
    int number = 0;
    std::from_chars(file.data() + 5, file.data() + file.size(), number);
    const Descriptor opened = openFile(entry.path());
    if (isMouse(opened.get())) found.emplace(number, ListedMouse{entry.path(), nameOf(opened.get())});
  }
  std::vector<ListedMouse> out;
  out.reserve(found.size());
  for (auto& [number, mouse] : found) out.push_back(std::move(mouse));
  return out;
}

EvdevMouse::EvdevMouse(std::string which, Hand hand, DeviceClock clock)
    : PointerDevice(std::move(clock), mouseKind.name, evdevReach), which_(std::move(which)), hand_(hand) {
  connectFirst(fmt::format("mouse \"{}\"", which_));
  info_.identity = fmt::format("mouse:{}", name_);
}

std::string EvdevMouse::find() {
  std::filesystem::path path;
  if (which_.starts_with("/")) {
    path = which_;
  } else {
    const std::vector<ListedMouse> mice = listMice();
    std::size_t number = mice.size();
    const auto [end, fault] = std::from_chars(which_.data(), which_.data() + which_.size(), number);
    const bool numbered = fault == std::errc() && end == which_.data() + which_.size();
    for (std::size_t i = 0; i < mice.size() && path.empty(); ++i) {
      if (numbered ? i == number : mice[i].name.find(which_) != std::string::npos) path = mice[i].path;
    }
    if (path.empty())
      return fmt::format("there is none such among {} that may be read; reading /dev/input needs the group input",
                         mice.size());
  }
  descriptor_ = openFile(path);
  if (!descriptor_.valid()) return fmt::format("{}: {}", path.string(), std::strerror(errno));
  const auto refuse = [&](const char* why) {
    disconnect();
    return fmt::format("{}: {}", path.string(), why);
  };
  // A stream that is no device has no grab; a mouse that another program has grabbed gives nothing.
  if (::ioctl(descriptor_.get(), EVIOCGRAB, 1) < 0 && errno == EBUSY) return refuse("another program has grabbed it");
  // Numbers of mice change when one is unplugged: another one is not taken for it.
  const std::string name = nameOf(descriptor_.get());
  if (!name_.empty() && name != name_) return refuse("another mouse");
  name_ = name;
  info_.detail = fmt::format("{}, {}", name_, path.string());
  return {};
}

void EvdevMouse::disconnect() {
  descriptor_.close();  // which ends the grab, too
  held_.fill(false);
  skipping_ = false;
  right_ = down_ = in_ = 0.0;
}

void EvdevMouse::take(std::uint16_t type, std::uint16_t code, std::int32_t value) {
  if (type == EV_SYN && code == SYN_DROPPED) {
    // The kernel's buffer overflowed: what is left of this report is not whole, and buttons are not known.
    skipping_ = true;
    held_.fill(false);
    return;
  }
  if (type == EV_SYN && code == SYN_REPORT) skipping_ = false;
  if (skipping_) return;
  if (type == EV_REL) {
    if (code == REL_X) right_ += pixel * value;
    if (code == REL_Y) down_ += pixel * value;
    if (code == REL_WHEEL) in_ += notch * value;
    if (code == REL_HWHEEL) pointer_.roll += tilt * value;
  } else if (type == EV_KEY && code >= BTN_MOUSE && code < BTN_MOUSE + held_.size()) {
    held_[static_cast<std::size_t>(code - BTN_MOUSE)] = value != 0;
  }
}

std::string EvdevMouse::readControls() {
  const bool there = readEvents(descriptor_.get(), [this](const input_event& e) { take(e.type, e.code, e.value); });
  return there ? "" : "unplugged";
}

bool EvdevMouse::holds(unsigned button) const { return held_[button - BTN_MOUSE]; }

void EvdevMouse::advance(double seconds, std::int64_t now, DeviceInput& out) {
  const double most = fastest * seconds;
  pointer_.move(Vec3(drawn(right_, most), drawn(down_, most), drawn(in_, most)), evdevReach);
  pointer_.openJaw(seconds * jawSpeed * between(holds(BTN_RIGHT), holds(BTN_LEFT)));
  DeviceSample& sample = out.samples.emplace_back(pointer_.sample(hand_, now));
  press(sample.buttons, holds(BTN_MIDDLE), button::cutPedal | button::fire);
  press(sample.buttons, holds(BTN_SIDE), button::coagulatePedal);
  press(sample.buttons, holds(BTN_EXTRA), button::lock);
}

}  // namespace calot::recorder
