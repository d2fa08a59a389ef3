// SPDX-License-Identifier: GPL-3.0-or-later
// Messages: docs.haply.co/inverseSDK, "Simulation Channel", "WebSocket Protocol" and "Basis Permutation", version 3.5.
#include "recorder/sources/devices/force/haply_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "recorder/sources/devices/pointer_device.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr std::chrono::milliseconds haplyPatience{500};
constexpr std::int64_t haplyPeriod = 1'000'000;             // ns from force to force
constexpr double haplyJawRate = 1.8, haplyWidestJaw = 1.2;  // rad/s, rad
constexpr double haplyReach = 1.0;                          // m; what lies farther is no measurement
constexpr double unitError = 0.01;

// The maker states none of these in the interface's documentation: assumed, on the side of too little force.
const TankModel haplyHandle{3.0, 0.3, 0.05, 1e-5, 0.001};

Vec3 fromHaply(const Vec3& v) { return {v.x(), -v.z(), v.y()}; }
Vec3 toHaply(const Vec3& v) { return {v.x(), v.z(), -v.y()}; }

using Json = nlohmann::json;

/// The value at a JSON pointer, or null. @param message may be null
const Json* at(const Json* message, const std::string& pointer) {
  const Json::json_pointer p(pointer);
  return message != nullptr && message->contains(p) ? &message->at(p) : nullptr;
}

std::string text(const Json& message, const char* pointer) {
  const Json* value = at(&message, pointer);
  return value != nullptr && value->is_string() ? nameFrom(value->get<std::string>().substr(0, 32).c_str()) : "";
}

/// Numbers with these names, or nothing where one is missing.
template <std::size_t N>
std::optional<std::array<double, N>> numbers(const Json* object, const std::array<const char*, N>& names) {
  std::array<double, N> out{};
  for (std::size_t i = 0; i < N; ++i) {
    const Json* value = at(object, names[i]);
    if (value == nullptr || !value->is_number()) return std::nullopt;
    out[i] = value->get<double>();
  }
  return out;
}

std::optional<Vec3> vectorOf(const Json* object) {
  const auto v = numbers<3>(object, {"/x", "/y", "/z"});
  if (!v) return std::nullopt;
  const Vec3 out(v->data());
  if (!out.allFinite() || out.norm() > haplyReach) return std::nullopt;
  return out;
}

std::optional<Quat> rotationOf(const Json* object) {
  const auto q = numbers<4>(object, {"/w", "/x", "/y", "/z"});
  if (!q) return std::nullopt;
  const Vec3 axis = fromHaply(Vec3(q->data() + 1));
  const Quat out((*q)[0], axis.x(), axis.y(), axis.z());
  if (!(std::abs(out.norm() - 1.0) <= unitError)) return std::nullopt;
  return out.normalized();
}

bool pressed(const Json& grip, const char* name) {
  const Json* value = at(&grip, fmt::format("/state/buttons/{}", name));
  return value != nullptr && value->is_boolean() && value->get<bool>();
}

/// The i-th element of an array of that name, or null.
const Json* element(const Json& message, const char* name, std::size_t i) {
  return at(&message, fmt::format("/{}/{}", name, i));
}

}  // namespace

HaplyDevice::HaplyDevice(HaplySettings settings, DeviceClock clock)
    : ForceFeedbackDevice(std::move(clock)), settings_(std::move(settings)) {
  connectFirst(fmt::format("Haply's Inverse Service at {}:{}", settings_.host, settings_.port));
  gone_ = "the service is gone";
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

std::string HaplyDevice::connect() {
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
    std::size_t hand = text(*device, "/config/handedness") == "left" ? 0 : 1;
    if (settings_.hand && inventory["inverse3"].size() == 1) hand = static_cast<std::size_t>(*settings_.hand);
    if (settings_.hand && hand != static_cast<std::size_t>(*settings_.hand)) continue;
    if (id[hand].empty()) id[hand] = text(*device, "/device_id");
  }
  if (id[0].empty() && id[1].empty()) return refuse("it has no Inverse3");
  const bool known = handle_[0].has_value() || handle_[1].has_value();
  for (std::size_t h = 0; h < handCount; ++h) {
    if (known && id[h] != (handle_[h] ? handle_[h]->id : "")) return refuse("another Inverse3 is there");
    if (known || id[h].empty()) continue;
    Handle handle;
    handle.id = id[h];
    handle_[h] = std::move(handle);
    output_[h].emplace(HandleModel{haplyHandle, {}});
  }
  introduced_ = toldMalformed_ = false;
  due_ = true;
  return {};
}

void HaplyDevice::sample(std::size_t hand, const Json& device, const Json* grip, DeviceInput& out) {
  Handle& handle = *handle_[hand];
  const std::int64_t now = clock_();
  const std::optional<Vec3> position = vectorOf(at(&device, "/state/cursor_position"));
  DeviceSample s;
  s.hostTime = now;
  s.sequence = handle.sequence++;
  s.hand = static_cast<Hand>(hand);
  s.valid = position.has_value();
  if (position) s.position = fromHaply(*position);
  bool clutched = false;
  if (grip != nullptr) {
    s.orientation = rotationOf(at(grip, "/state/orientation")).value_or(s.orientation);
    const bool a = pressed(*grip, "a"), b = pressed(*grip, "b");
    clutched = a && b;
    const double seconds = std::clamp(1e-9 * static_cast<double>(now - handle.time), 0.0, 0.05);
    handle.jaw = std::min(notNegative(handle.jaw + haplyJawRate * seconds * between(b, a)), haplyWidestJaw);
    if (clutched) s.buttons = clutchButton;
    press(s.buttons, pressed(*grip, "c"), button::cutPedal | button::fire);
  }
  handle.time = now;
  s.gripper = handle.jaw;
  out.samples.push_back(s);

  const HandleMeasurement measurement{.position = s.position,
                                      .deviceTime = now,
                                      // The state answers the last command: until then the one before it was in force.
                                      .number = std::max(1U, output_[hand]->number()) - 1,
                                      .shown = handle.shown,
                                      .valid = s.valid,
                                      .clutched = clutched};
  handle.shown = handle.last;
  handle.last = measured(hand, measurement, now);
}

void HaplyDevice::take(const std::string& message, DeviceInput& out) {
  const Json state = Json::parse(message, nullptr, false);
  if (state.is_discarded()) {
    if (!std::exchange(toldMalformed_, true))
      tell(DeviceEvent::Kind::malformed, info_.identity + ": a message that is not JSON", out);
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
      if (text(*device, "/device_id") != handle_[h]->id) continue;
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

void HaplyDevice::read(std::chrono::nanoseconds wait, DeviceInput& out) {
  if (due_) {
    const std::int64_t early = sent_ + haplyPeriod - clock_();
    if (early > 0 && wait.count() == 0) return;
    if (early > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(early));
    sendForces();
  }
  std::string message;
  if (stream_.receive(message, wait)) take(message, out);
}

OpenedDevice openHaply(const DeviceRequest& request) {
  HaplySettings settings;
  settings.hand = request.hand;
  request.readAddress(settings.host, settings.port);
  return {std::make_unique<HaplyDevice>(std::move(settings)), nullptr};
}

}  // namespace calot::recorder
