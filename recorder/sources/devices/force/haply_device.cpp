// SPDX-License-Identifier: GPL-3.0-or-later
// Messages: docs.haply.co/inverseSDK, "Simulation Channel", "WebSocket Protocol" and "Basis Permutation", version 3.5.
#include "recorder/sources/devices/force/haply_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr std::int64_t haplyRetry = 500'000'000;  // ns from one attempt to connect to the next
constexpr std::chrono::milliseconds haplyPatience{500};
constexpr std::int64_t haplyPeriod = 1'000'000;             // ns from force to force
constexpr std::int64_t haplyFall = 200'000'000;             // ns, the longest fall of the force at the end
constexpr double haplyJawRate = 1.8, haplyWidestJaw = 1.2;  // rad/s, rad
constexpr double haplyReach = 1.0;                          // m; what lies farther is no measurement
constexpr double unitError = 0.01;

// The maker states none of these in the interface's documentation: assumed, on the side of too little force.
const TankModel haplyHandle{3.0, 0.3, 0.05, 1e-5, 0.001};

Vec3 fromHaply(const Vec3& v) { return {v.x(), -v.z(), v.y()}; }
Vec3 toHaply(const Vec3& v) { return {v.x(), v.z(), -v.y()}; }

using Json = nlohmann::json;

const Json* member(const Json& object, const char* name) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

std::optional<double> number(const Json& object, const char* name) {
  const Json* value = member(object, name);
  if (value == nullptr || !value->is_number()) return std::nullopt;
  return value->get<double>();
}

std::string text(const Json& object, const char* name) {
  const Json* value = member(object, name);
  if (value == nullptr || !value->is_string()) return {};
  std::string out = value->get<std::string>().substr(0, 32);
  for (char& c : out) {
    if (c < 0x20 || c >= 0x7f) c = '?';
  }
  return out;
}

std::optional<Vec3> vectorOf(const Json* object) {
  if (object == nullptr) return std::nullopt;
  const auto x = number(*object, "x"), y = number(*object, "y"), z = number(*object, "z");
  if (!x || !y || !z) return std::nullopt;
  const Vec3 out(*x, *y, *z);
  if (!out.allFinite() || out.norm() > haplyReach) return std::nullopt;
  return out;
}

std::optional<Quat> rotationOf(const Json* object) {
  if (object == nullptr) return std::nullopt;
  const auto w = number(*object, "w"), x = number(*object, "x"), y = number(*object, "y"), z = number(*object, "z");
  if (!w || !x || !y || !z) return std::nullopt;
  const Vec3 axis = fromHaply(Vec3(*x, *y, *z));
  const Quat out(*w, axis.x(), axis.y(), axis.z());
  if (!(std::abs(out.norm() - 1.0) <= unitError)) return std::nullopt;
  return out.normalized();
}

bool pressed(const Json& grip, const char* name) {
  const Json* state = member(grip, "state");
  const Json* buttons = state != nullptr ? member(*state, "buttons") : nullptr;
  const Json* value = buttons != nullptr ? member(*buttons, name) : nullptr;
  return value != nullptr && value->is_boolean() && value->get<bool>();
}

/// The i-th element of an array of that name, or null.
const Json* element(const Json& message, const char* name, std::size_t i) {
  const Json* list = member(message, name);
  return list != nullptr && list->is_array() && i < list->size() ? &(*list)[i] : nullptr;
}

HaplySettings haplySettings(const DeviceRequest& request) {
  HaplySettings out;
  out.hand = request.hand;
  if (request.argument.empty()) return out;
  std::string port;
  out.host = request.argument;
  if (const std::size_t colon = out.host.rfind(':'); colon != std::string::npos) {
    port = out.host.substr(colon + 1);
    out.host = out.host.substr(0, colon);
    if (port.empty()) request.refuse("a port is missing behind the colon");
  }
  for (const char c : out.host) {
    if (c <= 0x20 || c >= 0x7f || c == '/' || c == ':') request.refuse("the host is no name or address");
  }
  if (out.host.empty() || out.host.size() > 253) request.refuse("a host is missing: haply:HOST:PORT");
  if (port.empty()) return out;
  const auto [end, fault] = std::from_chars(port.data(), port.data() + port.size(), out.port);
  if (fault != std::errc() || end != port.data() + port.size() || out.port < 1 || out.port > 65535)
    request.refuse("the port is no number from 1 to 65535");
  return out;
}

}  // namespace

HaplyDevice::Handle::Handle(std::string name) : id(std::move(name)), output({haplyHandle, {}}) {}

HaplyDevice::HaplyDevice(HaplySettings settings, DeviceClock clock)
    : settings_(std::move(settings)), clock_(std::move(clock)) {
  const std::string fault = connect();
  if (!fault.empty()) {
    throw Error(ErrorKind::failure,
                fmt::format("Haply's Inverse Service at {}:{}: {}", settings_.host, settings_.port, fault),
                {Remedy::listDevices});
  }
  std::string ids;
  DeviceCapabilities& c = info_.capabilities;
  c.hands = 0;
  for (std::size_t h = 0; h < handCount; ++h) {
    if (!handle_[h]) continue;
    ids += fmt::format("{}{}", ids.empty() ? "" : ",", handle_[h]->id);
    ++c.hands;
  }
  info_.name = haplyKind.name;
  info_.identity = "haply:" + ids;
  info_.detail =
      fmt::format("Inverse3 {} by the service at {}:{}; not yet run on hardware", ids, settings_.host, settings_.port);
  c.sensesGripper = true;
  c.actuated = 3;
  c.maxForce = haplyHandle.maxEffort;
  c.rate = 1000.0;
}

HaplyDevice::~HaplyDevice() { close(); }

std::string HaplyDevice::connect() {
  nextAttempt_ = clock_() + haplyRetry;
  std::string fault, first;
  stream_ = WebSocketStream::connect(settings_.host, settings_.port, haplyPatience, fault);
  if (!stream_.open()) return fault;
  const auto refuse = [this](const char* why) {
    stream_.close();
    return std::string(why);
  };
  if (!stream_.receive(first, haplyPatience)) return refuse("it does not say what devices there are");
  const Json inventory = Json::parse(first, nullptr, false);
  std::array<std::string, handCount> id;
  for (std::size_t i = 0; const Json* device = element(inventory, "inverse3", i); ++i) {
    const Json* config = member(*device, "config");
    const bool left = config != nullptr && text(*config, "handedness") == "left";
    std::size_t hand = left ? 0 : 1;
    if (settings_.hand && member(inventory, "inverse3")->size() == 1) hand = static_cast<std::size_t>(*settings_.hand);
    if (settings_.hand && hand != static_cast<std::size_t>(*settings_.hand)) continue;
    if (id[hand].empty()) id[hand] = text(*device, "device_id");
  }
  if (id[0].empty() && id[1].empty()) return refuse("it has no Inverse3");
  const bool known = handle_[0].has_value() || handle_[1].has_value();
  for (std::size_t h = 0; h < handCount; ++h) {
    if (known && id[h] != (handle_[h] ? handle_[h]->id : "")) return refuse("another Inverse3 is there");
    if (!known && !id[h].empty()) handle_[h].emplace(id[h]);
  }
  introduced_ = false;
  due_ = true;
  return {};
}

void HaplyDevice::lose(const std::string& why, DeviceInput& out) {
  stream_.close();
  nextAttempt_ = clock_() + haplyRetry;
  greeted_ = false;
  refusal_.clear();
  for (auto& handle : handle_) {
    if (handle) handle->output.lost();
  }
  out.events.push_back({DeviceEvent::Kind::disconnected, clock_(), fmt::format("{}: {}", info_.identity, why)});
}

void HaplyDevice::sample(std::size_t hand, const Json& device, const Json* grip, DeviceInput& out) {
  Handle& handle = *handle_[hand];
  const std::int64_t now = clock_();
  const Json* state = member(device, "state");
  const std::optional<Vec3> position = vectorOf(state != nullptr ? member(*state, "cursor_position") : nullptr);
  DeviceSample s;
  s.hostTime = now;
  s.sequence = handle.sequence++;
  s.hand = static_cast<Hand>(hand);
  s.valid = position.has_value();
  if (position) s.position = fromHaply(*position);
  bool clutched = false;
  if (grip != nullptr) {
    const Json* gripState = member(*grip, "state");
    const std::optional<Quat> turned = rotationOf(gripState != nullptr ? member(*gripState, "orientation") : nullptr);
    if (turned) s.orientation = *turned;
    const bool a = pressed(*grip, "a"), b = pressed(*grip, "b");
    clutched = a && b;
    const double seconds = std::clamp(1e-9 * static_cast<double>(now - handle.time), 0.0, 0.05);
    const double open = (b ? 1.0 : 0.0) - (a ? 1.0 : 0.0);
    handle.jaw = std::min(notNegative(handle.jaw + haplyJawRate * seconds * open), haplyWidestJaw);
    if (clutched) s.buttons = clutchButton;
    if (pressed(*grip, "c")) s.buttons = static_cast<std::uint8_t>(s.buttons | button::cutPedal | button::fire);
  }
  handle.time = now;
  s.gripper = handle.jaw;
  out.samples.push_back(s);

  HandleMeasurement m;
  m.position = s.position;
  m.deviceTime = now;
  m.valid = s.valid;
  m.clutched = clutched;
  // The state answers the last command: until then the one before it was in force.
  m.number = handle.output.number() > 0 ? handle.output.number() - 1 : 0;
  m.shown = handle.shown;
  handle.shown = handle.last;
  handle.last = handle.output.measured(m, now);
  reports_.note(hand, handle.output.statistics());
}

void HaplyDevice::take(const std::string& message, DeviceInput& out) {
  const Json state = Json::parse(message, nullptr, false);
  if (state.is_discarded()) {
    if (!std::exchange(toldMalformed_, true))
      out.events.push_back({DeviceEvent::Kind::malformed, clock_(), info_.identity + ": a message that is no JSON"});
    due_ = true;
    return;
  }
  bool any = false;
  std::size_t grips = 0;
  for (const std::size_t h : {std::size_t{1}, std::size_t{0}}) {
    if (!handle_[h]) continue;
    const Json* grip = element(state, "wireless_verse_grip", grips);
    if (grip == nullptr) grip = element(state, "verse_grip", grips);
    ++grips;
    for (std::size_t i = 0; const Json* device = element(state, "inverse3", i); ++i) {
      if (text(*device, "device_id") != handle_[h]->id) continue;
      sample(h, *device, grip, out);
      any = true;
      break;
    }
  }
  if (!any) {
    lose("the Inverse3 is gone", out);
    return;
  }
  due_ = true;
}

void HaplyDevice::sendForces() {
  Json message;
  if (!std::exchange(introduced_, true)) message["session"]["configure"]["profile"]["name"] = "calot";
  Json list = Json::array();
  for (const auto& handle : handle_) {
    if (!handle) continue;
    const Vec3 force = toHaply(handle->last.force);
    list.push_back(
        {{"device_id", handle->id},
         {"commands", {{"set_cursor_force", {{"values", {{"x", force.x()}, {"y", force.y()}, {"z", force.z()}}}}}}}});
  }
  message["inverse3"] = std::move(list);
  stream_.send(message.dump());
  sent_ = clock_();
  due_ = false;
}

void HaplyDevice::poll(std::chrono::nanoseconds wait, DeviceInput& out) {
  if (!open_) return;
  if (!stream_.open()) {
    if (greeted_) {
      lose("the service is gone", out);
      return;
    }
    if (clock_() < nextAttempt_) {
      std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(wait, std::chrono::milliseconds(20)));
      return;
    }
    const std::string fault = connect();
    if (fault != refusal_ && !fault.empty())
      out.events.push_back({DeviceEvent::Kind::disconnected, clock_(), fmt::format("{}: {}", info_.identity, fault)});
    refusal_ = fault;
    if (!stream_.open()) return;
  }
  if (!std::exchange(greeted_, true)) {
    toldMalformed_ = false;
    out.events.push_back({DeviceEvent::Kind::connected, clock_(), info_.identity + ": there"});
  }
  if (due_) {
    const std::int64_t early = sent_ + haplyPeriod - clock_();
    if (early > 0 && wait.count() == 0) return;
    if (early > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(early));
    sendForces();
  }
  std::string message;
  if (stream_.receive(message, wait)) take(message, out);
}

void HaplyDevice::setWrench(Hand hand, const Wrench& wrench) {
  auto& handle = handle_[static_cast<std::size_t>(hand)];
  if (handle) handle->output.command({wrench.force, Vec3::Zero()}, clock_());
}

void HaplyDevice::close() {
  if (!open_) return;
  for (auto& handle : handle_) {
    if (handle) handle->output.release();
  }
  const auto idle = [this] {
    return std::all_of(handle_.begin(), handle_.end(), [](const auto& h) { return !h || h->output.idle(); });
  };
  const std::int64_t until = clock_() + haplyFall;
  DeviceInput unread;
  while (stream_.open() && !idle() && clock_() < until) poll(std::chrono::milliseconds(2), unread);
  if (stream_.open()) sendForces();
  open_ = false;
  stream_.close();
}

constinit const DeviceKind haplyKind{
    .name = "haply",
    .usage = "haply[:HOST[:PORT]]",
    .help = "Haply Inverse3 by its Inverse Service; not yet run on hardware",
    .list =
        [] {
          return std::vector<ListedDevice>{{"haply:HOST:PORT",
                                            "Haply Inverse3 by its Inverse Service, default localhost:10001; not yet "
                                            "run on hardware",
                                            true, "2", "3, orientation and buttons of a VerseGrip; shows force",
                                            "1000"}};
        },
    .open =
        [](const DeviceRequest& request) {
          return OpenedDevice{std::make_unique<HaplyDevice>(haplySettings(request)), nullptr};
        },
};

}  // namespace calot::recorder
