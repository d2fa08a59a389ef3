// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/open_device.h"

#include <fmt/format.h>
#include <algorithm>
#include <iterator>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/sources/devices/camera/camera_device.h"
#include "recorder/sources/devices/device_script.h"
#include "recorder/sources/devices/force/force_device.h"
#include "recorder/sources/devices/force/haply_device.h"
#include "recorder/sources/devices/mouse_device.h"
#include "recorder/sources/devices/openigtlink_device.h"
#include "recorder/sources/devices/pointer_device.h"

namespace calot::recorder {

// Kinds whose drivers need libraries of others (drivers/).

constinit const DeviceKind gamepadKind{
    .name = "gamepad",
    .usage = "gamepad[:NAME]",
    .help = "the first gamepad whose name contains NAME; drives one hand at a time",
    .row = {"gamepad", "", "1 at a time", "3 + roll, jaw, buttons", "250"},
    .list = listGamepads,
    .open = openGamepad,
};

constinit const DeviceKind spaceMouseKind{
    .name = "spacenav",
    .usage = "spacenav",
    .help = "SpaceMouse by spacenavd; drives one hand",
    .row = {"spacenav", "SpaceMouse, where spacenavd runs", "1", "3 + roll, jaw, buttons", "250"},
    .open = openSpaceMouse,
};

constinit const DeviceKind openIgtLinkKind{
    .name = "openigtlink",
    .usage = "openigtlink[:HOST[:PORT]]",
    .help = "tracked tools of an OpenIGTLink server",
    .row = {"openigtlink:HOST:PORT", "a server's tracked tools; default localhost:18944", "2", "6, jaw by SENSOR",
            "the server's"},
    .open = openOpenIgtLink,
};

constinit const DeviceKind haplyKind{
    .name = "haply",
    .usage = "haply[:HOST[:PORT]]",
    .help = "Haply Inverse3 by its Inverse Service; not yet run on hardware",
    .row = {"haply:HOST:PORT",
            "Haply Inverse3 by its Inverse Service, default localhost:10001; not yet run on hardware", "2",
            "3, orientation and buttons of a VerseGrip; shows force", "1000"},
    .open = openHaply,
};

namespace {

// References, so that the linker keeps every device of the library.
constexpr std::array kinds{&gamepadKind,  &forceKind, &haplyKind, &openIgtLinkKind, &cameraKind,
                           &scriptedKind, &nullKind,  &mouseKind, &spaceMouseKind};

}  // namespace

std::span<const DeviceKind* const> deviceKinds() { return kinds; }

const DeviceKind* findDeviceKind(std::string_view name) {
  const std::string_view kind = name.substr(0, name.find(':'));
  for (const DeviceKind* known : kinds) {
    if (known->name == kind) return known;
  }
  return nullptr;
}

std::string deviceUsage(std::string_view last) {
  std::vector<std::string> usages;
  for (const DeviceKind* kind : kinds) {
    if (!kind->needsWindow) usages.emplace_back(kind->usage);
  }
  const std::string final = usages.back();
  usages.pop_back();
  return fmt::format("{} {} {}", fmt::join(usages, ", "), last, final);
}

OpenedDevice openDevice(const std::string& name, const std::array<std::string, handCount>& tools,
                        const Calibration* calibration, std::optional<Hand> hand) {
  if (isCombination(name)) return openCombination(name, tools);
  const std::size_t colon = name.find(':');
  const DeviceRequest request{name, colon == std::string::npos ? "" : name.substr(colon + 1), tools, calibration, hand};
  if (colon != std::string::npos && request.argument.empty()) request.refuse("something is missing behind the colon");
  const DeviceKind* const kind = findDeviceKind(name);
  if (kind == nullptr) {
    std::vector<std::string> known;
    known.reserve(std::size(kinds));
    for (const DeviceKind* each : kinds) known.emplace_back(each->name);
    request.refuse(
        fmt::format("no such device{}; there are {}", didYouMean(name.substr(0, colon), known), deviceUsage("and")));
  }
  return kind->open(request);
}

std::vector<ListedDevice> DeviceKind::listed() const {
  try {
    if (list != nullptr) return list();
    return {{row[0], row[1], true, row[2], row[3], row[4]}};
  } catch (const Error& e) {
    return {{row[0], e.what(), false, row[2], row[3], row[4]}};
  }
}

std::vector<ListedDevice> listDevices() {
  std::vector<ListedDevice> out;
  for (const DeviceKind* kind : kinds) {
    const std::vector<ListedDevice> those = kind->listed();
    out.insert(out.end(), those.begin(), those.end());
  }
  return out;
}

namespace {
constexpr std::int64_t period = 1'000'000;  // ns
constexpr std::int64_t maxAtOnce = 1000;    // samples; a poll after a long pause does not make up for all of it
}  // namespace

NullDevice::NullDevice(DeviceClock clock) : Device(std::move(clock)), next_(clock_()) {
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
  if (sequence_ == 0) tell(DeviceEvent::Kind::connected, "null: there", out);
  next_ = std::max(next_, now - maxAtOnce * period);
  for (; next_ <= now; next_ += period, ++sequence_) {
    for (const Hand hand : {Hand::left, Hand::right}) {
      out.samples.push_back({.deviceTime = next_, .hostTime = next_, .sequence = sequence_, .hand = hand});
    }
  }
}

constinit const DeviceKind nullKind{
    .name = "null",
    .usage = "null",
    .help = "never moves",
    .row = {"null", "never moves", "2", "none", "1000"},
    .open =
        [](const DeviceRequest& request) {
          if (!request.argument.empty()) request.refuse("nothing stands behind its name");
          auto ticks = std::make_shared<TickClock>();
          return OpenedDevice{std::make_unique<NullDevice>([ticks] { return ticks->now; }), ticks};
        },
};

namespace {

constexpr std::chrono::microseconds breath{500};  // between two rounds where nothing came

/// "left=A,right=B" or the other way round; a name may have commas of its own.
std::array<std::string, handCount> partsOf(const DeviceRequest& request) {
  std::array<std::string, handCount> out;
  std::string rest = request.name;
  while (!rest.empty()) {
    std::size_t hand = handCount;
    for (std::size_t h = 0; h < handCount; ++h) {
      if (rest.starts_with(std::string(handNames[h]) + "=")) hand = h;
    }
    if (hand == handCount) request.refuse("two devices are asked for by left=DEVICE,right=DEVICE");
    rest = rest.substr(std::string(handNames[hand]).size() + 1);
    const std::size_t end = std::min(rest.find(",left="), rest.find(",right="));
    if (!out[hand].empty()) request.refuse(fmt::format("the {} hand has two devices", handNames[hand]));
    out[hand] = rest.substr(0, end);
    if (out[hand].empty()) request.refuse(fmt::format("the {} hand's device is missing", handNames[hand]));
    rest = end == std::string::npos ? "" : rest.substr(end + 1);
  }
  for (std::size_t h = 0; h < handCount; ++h) {
    if (out[h].empty())
      request.refuse(
          fmt::format("the {} hand has no device; one alone is asked for without left= and right=", handNames[h]));
  }
  return out;
}

OperatorKind operatorOf(OperatorKind a, OperatorKind b) {
  for (const OperatorKind kind : {OperatorKind::human, OperatorKind::kinematics}) {
    if (a == kind || b == kind) return kind;
  }
  return a;
}

}  // namespace

CombinedDevice::CombinedDevice(std::array<OpenedDevice, handCount> device, std::shared_ptr<TickClock> tickClock)
    : device_(std::move(device)), tickClock_(std::move(tickClock)) {
  const DeviceInfo& left = device_[0].device->info();
  const DeviceInfo& right = device_[1].device->info();
  info_.name = fmt::format("{}+{}", left.name, right.name);
  info_.identity = fmt::format("left={},right={}", left.identity, right.identity);
  info_.detail = fmt::format("left: {}; right: {}", left.detail, right.detail);
  info_.operatorKind = operatorOf(left.operatorKind, right.operatorKind);
  const DeviceInfo& file = left.sourceFile.empty() ? right : left;
  info_.sourceFile = file.sourceFile;
  info_.sourceSha256 = file.sourceSha256;
  const DeviceCapabilities& a = left.capabilities;
  const DeviceCapabilities& b = right.capabilities;
  DeviceCapabilities& c = info_.capabilities;
  c.hands = handCount;
  c.sensedRotations = std::min(a.sensedRotations, b.sensedRotations);
  c.sensesGripper = a.sensesGripper && b.sensesGripper;
  c.actuated = std::max(a.actuated, b.actuated);
  c.maxForce = std::max(a.maxForce, b.maxForce);
  c.maxTorque = std::max(a.maxTorque, b.maxTorque);
  c.rate = std::max(a.rate, b.rate);
  c.realTime = !tickClock_;
  c.absolute = a.absolute && b.absolute;
}

bool CombinedDevice::pollOne(std::size_t hand, DeviceInput& out) {
  OpenedDevice& one = device_[hand];
  if (tickClock_) *one.tickClock = *tickClock_;
  DeviceInput input;
  one.device->poll(std::chrono::nanoseconds(0), input);
  for (DeviceEvent& event : input.events) {
    event.text = fmt::format("{}: {}", handNames[hand], event.text);
    if (event.kind == DeviceEvent::Kind::disconnected) there_[hand] = false;
    if (event.kind == DeviceEvent::Kind::connected) {
      there_[hand] = true;
      // The combination is there once both are.
      if (!there_[1 - hand]) event.kind = DeviceEvent::Kind::status;
    }
    out.events.push_back(std::move(event));
  }
  const auto wanted = static_cast<Hand>(hand);
  std::copy_if(input.samples.begin(), input.samples.end(), std::back_inserter(out.samples),
               [wanted](const DeviceSample& s) { return s.hand == wanted; });
  return !input.samples.empty() || !input.events.empty();
}

void CombinedDevice::poll(std::chrono::nanoseconds wait, DeviceInput& out) {
  const auto until = std::chrono::steady_clock::now() + wait;
  for (;;) {
    bool any = false;
    for (std::size_t h = 0; h < handCount; ++h) any = pollOne(h, out) || any;
    if (any || std::chrono::steady_clock::now() + breath > until) return;
    std::this_thread::sleep_for(breath);
  }
}

bool CombinedDevice::connected() const { return device_[0].device->connected() && device_[1].device->connected(); }

bool CombinedDevice::ended() const { return device_[0].device->ended() && device_[1].device->ended(); }

void CombinedDevice::setOut(Hand hand, const HandStart& start) {
  device_[static_cast<std::size_t>(hand)].device->setOut(hand, start);
}

void CombinedDevice::setWrench(Hand hand, const Wrench& wrench) {
  device_[static_cast<std::size_t>(hand)].device->setWrench(hand, wrench);
}

void CombinedDevice::close() {
  for (OpenedDevice& one : device_) one.device->close();
}

std::array<ForceStatistics, handCount> CombinedDevice::forceStatistics() const {
  return {device_[0].device->forceStatistics()[0], device_[1].device->forceStatistics()[1]};
}

bool isCombination(const std::string& name) { return name.starts_with("left=") || name.starts_with("right="); }

OpenedDevice openCombination(const std::string& name, const std::array<std::string, handCount>& tools) {
  const DeviceRequest request{name, "", tools};
  const std::array<std::string, handCount> part = partsOf(request);
  std::array<OpenedDevice, handCount> device;
  for (std::size_t h = 0; h < handCount; ++h) {
    if (isCombination(part[h])) request.refuse("a combination has no combinations in it");
    std::array<std::string, handCount> own;
    own[h] = tools[h];
    device[h] = openDevice(part[h], own, nullptr, static_cast<Hand>(h));
  }
  const bool ticks = device[0].tickClock != nullptr;
  if (ticks != (device[1].tickClock != nullptr))
    request.refuse("one of them lives in real time and the other on the tick clock; they cannot run together");
  const DeviceInfo& left = device[0].device->info();
  const DeviceInfo& right = device[1].device->info();
  if (!left.sourceFile.empty() && !right.sourceFile.empty() && left.sourceSha256 != right.sourceSha256)
    request.refuse("two different files; put both hands into one script");
  auto clock = ticks ? std::make_shared<TickClock>() : nullptr;
  return {std::make_unique<CombinedDevice>(std::move(device), clock), clock};
}

}  // namespace calot::recorder
