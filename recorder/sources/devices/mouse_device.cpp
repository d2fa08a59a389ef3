// SPDX-License-Identifier: GPL-3.0-or-later
// The kernel's interface itself (linux/input.h): a reader of relative axes and buttons is shorter than a library's
// set-up, and takes events from any stream, which tests without a mouse need.

#include "recorder/sources/devices/mouse_device.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/input.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"
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

namespace {

constexpr std::int64_t samplePeriod = 4'000'000;    // ns
constexpr std::int64_t searchPeriod = 500'000'000;  // ns, of a lost mouse
constexpr double maxGap = 0.05;                     // s; after a longer one the tip does not leap
constexpr double aCount = 0.00015, aNotch = 0.003;  // m
constexpr double aTilt = 0.1, jawRate = 1.8;        // rad, rad/s
constexpr double widestJaw = 1.2;                   // rad
constexpr double fastestMotion = 0.5;               // m/s
constexpr double mouseReach = 0.15;                 // m, each axis

bool hasBit(const std::array<unsigned char, KEY_MAX / 8 + 1>& bits, unsigned bit) {
  return (bits[bit / 8] & (1U << (bit % 8))) != 0;
}

std::string nameOf(int descriptor) {
  std::array<char, 128> text{};
  if (::ioctl(descriptor, EVIOCGNAME(text.size() - 1), text.data()) < 0) return "mouse";
  std::string out;
  for (const char* c = text.data(); *c != '\0' && out.size() < 64; ++c) out += *c >= 0x20 && *c < 0x7f ? *c : '?';
  return out;
}

bool isMouse(int descriptor) {
  std::array<unsigned char, KEY_MAX / 8 + 1> axes{}, keys{};
  if (::ioctl(descriptor, EVIOCGBIT(EV_REL, axes.size()), axes.data()) < 0) return false;
  if (::ioctl(descriptor, EVIOCGBIT(EV_KEY, keys.size()), keys.data()) < 0) return false;
  return hasBit(axes, REL_X) && hasBit(axes, REL_Y) && hasBit(keys, BTN_LEFT);
}

int openFile(const std::filesystem::path& path) { return ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC); }

double takeUpTo(double& wish, double most) {
  const double part = std::clamp(wish, -most, most);
  wish -= part;
  return part;
}

}  // namespace

std::vector<ListedMouse> listMice() {
  std::vector<std::pair<int, ListedMouse>> found;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/input", ignored)) {
    const std::string file = entry.path().filename().string();
    if (!file.starts_with("event")) continue;
    int number = 0;
    std::from_chars(file.data() + 5, file.data() + file.size(), number);
    const int descriptor = openFile(entry.path());
    if (descriptor < 0) continue;
    if (isMouse(descriptor)) found.emplace_back(number, ListedMouse{entry.path(), nameOf(descriptor)});
    ::close(descriptor);
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<ListedMouse> out;
  out.reserve(found.size());
  for (auto& [number, mouse] : found) out.push_back(std::move(mouse));
  return out;
}

EvdevMouse::EvdevMouse(std::string which, Hand hand, DeviceClock clock)
    : which_(std::move(which)), hand_(hand), clock_(std::move(clock)) {
  const std::string fault = open();
  if (!fault.empty())
    throw Error(ErrorKind::failure, fmt::format("mouse \"{}\": {}", which_, fault), {Remedy::listDevices});
  name_ = nameOf(descriptor_);
  info_.name = "mouse";
  info_.identity = fmt::format("mouse:{}", name_);
  info_.detail = fmt::format("{}, {}", name_, path_.string());
  DeviceCapabilities& c = info_.capabilities;
  c.hands = 1;
  c.sensedRotations = 1;
  c.sensesGripper = true;
  c.workspace = {Vec3::Constant(-mouseReach), Vec3::Constant(mouseReach)};
  c.rate = 250.0;
  c.absolute = false;
  last_ = clock_();
}

EvdevMouse::~EvdevMouse() { close(); }

std::string EvdevMouse::open() {
  path_.clear();
  if (which_.starts_with("/")) {
    path_ = which_;
  } else {
    const std::vector<ListedMouse> mice = listMice();
    std::size_t number = mice.size();
    const auto [end, fault] = std::from_chars(which_.data(), which_.data() + which_.size(), number);
    const bool numbered = fault == std::errc() && end == which_.data() + which_.size();
    for (std::size_t i = 0; i < mice.size() && path_.empty(); ++i) {
      if (numbered ? i == number : mice[i].name.find(which_) != std::string::npos) path_ = mice[i].path;
    }
    if (path_.empty())
      return fmt::format("there is none such among {} that may be read; reading /dev/input needs the group input",
                         mice.size());
  }
  descriptor_ = openFile(path_);
  if (descriptor_ < 0) return fmt::format("{}: {}", path_.string(), std::strerror(errno));
  // A stream that is no device has no grab; a mouse that another program has grabbed gives nothing.
  if (::ioctl(descriptor_, EVIOCGRAB, 1) < 0 && errno == EBUSY) {
    ::close(std::exchange(descriptor_, -1));
    return fmt::format("{}: another program has grabbed it", path_.string());
  }
  // Numbers of mice change when one is unplugged: another one is not taken for it.
  if (!name_.empty() && nameOf(descriptor_) != name_) {
    ::close(std::exchange(descriptor_, -1));
    return fmt::format("{}: another mouse", path_.string());
  }
  held_.fill(false);
  skipping_ = false;
  return {};
}

void EvdevMouse::close() {
  open_ = false;
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));  // which ends the grab, too
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
    if (code == REL_X) right_ += aCount * value;
    if (code == REL_Y) down_ += aCount * value;
    if (code == REL_WHEEL) in_ += aNotch * value;
    if (code == REL_HWHEEL) roll_ += aTilt * value;
  } else if (type == EV_KEY && code >= BTN_MOUSE && code < BTN_MOUSE + held_.size()) {
    held_[static_cast<std::size_t>(code - BTN_MOUSE)] = value != 0;
  }
}

void EvdevMouse::read() {
  std::array<input_event, 64> events;
  for (;;) {
    const ssize_t n = ::read(descriptor_, events.data(), sizeof events);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (n <= 0) {
      lost_ = true;
      return;
    }
    const std::size_t count = static_cast<std::size_t>(n) / sizeof(input_event);
    for (std::size_t i = 0; i < count; ++i) take(events[i].type, events[i].code, events[i].value);
    if (count < events.size()) return;
  }
}

void EvdevMouse::advance(double seconds) {
  const double most = fastestMotion * seconds;
  position_ += Vec3(takeUpTo(right_, most), takeUpTo(down_, most), takeUpTo(in_, most));
  position_ = position_.cwiseMax(-mouseReach).cwiseMin(mouseReach);
  const double open = (held_[BTN_RIGHT - BTN_MOUSE] ? 1.0 : 0.0) - (held_[BTN_LEFT - BTN_MOUSE] ? 1.0 : 0.0);
  jaw_ = std::min(notNegative(jaw_ + seconds * jawRate * open), widestJaw);
}

void EvdevMouse::poll(std::chrono::nanoseconds wait, DeviceInput& out) {
  if (!open_) return;
  std::int64_t now = clock_();
  if (descriptor_ < 0) {
    if (now < nextAttempt_) {
      std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(wait, std::chrono::milliseconds(20)));
      return;
    }
    nextAttempt_ = now + searchPeriod;
    if (!open().empty()) return;
    last_ = now;
    out.events.push_back({DeviceEvent::Kind::connected, now, info_.identity + ": there again"});
  } else if (!std::exchange(greeted_, true)) {
    out.events.push_back({DeviceEvent::Kind::connected, now, info_.identity + ": there"});
  }
  if (now < last_ + samplePeriod && wait.count() > 0) {
    std::this_thread::sleep_for(std::min(wait, std::chrono::nanoseconds(last_ + samplePeriod - now)));
    now = clock_();
  }
  if (now < last_ + samplePeriod) return;
  read();
  if (std::exchange(lost_, false)) {
    ::close(std::exchange(descriptor_, -1));
    nextAttempt_ = now + searchPeriod;
    right_ = down_ = in_ = 0.0;
    out.events.push_back({DeviceEvent::Kind::disconnected, now, info_.identity + ": unplugged"});
    return;
  }
  advance(std::min(maxGap, 1e-9 * static_cast<double>(now - last_)));
  last_ = now;
  DeviceSample sample;
  sample.hostTime = now;
  sample.sequence = sequence_++;
  sample.hand = hand_;
  sample.position = position_;
  sample.orientation = Quat(cosine(0.5 * roll_), 0.0, 0.0, sine(0.5 * roll_));
  sample.gripper = jaw_;
  const auto bit = [&](unsigned which, std::uint8_t mask) {
    if (held_[which - BTN_MOUSE]) sample.buttons = static_cast<std::uint8_t>(sample.buttons | mask);
  };
  bit(BTN_MIDDLE, button::cutPedal | button::fire);
  bit(BTN_SIDE, button::coagulatePedal);
  bit(BTN_EXTRA, button::lock);
  out.samples.push_back(sample);
}

}  // namespace calot::recorder
