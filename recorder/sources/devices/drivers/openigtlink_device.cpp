// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/openigtlink_device.h"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"

namespace calot::recorder {
namespace {

using openigtlink::Item;

constexpr std::chrono::milliseconds patience{300};
constexpr std::size_t maxFaults = 16;  // kinds of fault reported for a connection
constexpr double maxGripper = 3.2;     // rad
constexpr int statusOk = 1;

void checkTools(const std::array<std::string, handCount>& tools) {
  if (tools[0].empty() && tools[1].empty())
    throw Error(ErrorKind::invalid, "OpenIGTLink: at least one hand needs a tool", {Remedy::nameTools});
  if (tools[0] == tools[1])
    throw Error(ErrorKind::invalid, "OpenIGTLink: both hands have the same tool", {Remedy::nameTools});
  for (const std::string& tool : tools) {
    if (tool.size() > openigtlink::maxName)
      throw Error(ErrorKind::invalid,
                  fmt::format("OpenIGTLink: a tool's name has at most {} characters", openigtlink::maxName),
                  {Remedy::nameTools});
  }
}

}  // namespace

OpenIgtLinkDevice::OpenIgtLinkDevice(OpenIgtLinkSettings settings, DeviceClock clock)
    : ReopeningDevice(std::move(clock)), settings_(std::move(settings)) {
  gone_ = "the server is gone";
  info_.name = openIgtLinkKind.name;
  info_.identity = fmt::format("openigtlink:{}/{},{}", settings_.host, settings_.tool[0], settings_.tool[1]);
  info_.detail = fmt::format("server {}:{}, tools \"{}\" and \"{}\"", settings_.host, settings_.port, settings_.tool[0],
                             settings_.tool[1]);
  info_.capabilities.hands =
      static_cast<int>(!settings_.tool[0].empty()) + static_cast<int>(!settings_.tool[1].empty());
  info_.capabilities.sensesGripper = true;
}

std::string OpenIgtLinkDevice::connect() {
  std::string fault;
  stream_ = TcpStream::connect(settings_.host, settings_.port, patience, fault);
  decoder_.reset();
  told_.clear();
  gripper_.fill(0.0);
  return stream_.open() ? "" : fault;
}

void OpenIgtLinkDevice::tellOnce(DeviceEvent::Kind kind, const std::string& fault, DeviceInput& out) {
  if (told_.size() < maxFaults && told_.insert(fault).second) tell(kind, "openigtlink: " + fault, out);
}

void OpenIgtLinkDevice::take(const Item& item, DeviceInput& out) {
  if (item.kind == Item::Kind::unknown) return;
  if (item.kind == Item::Kind::status) {
    if (item.code != statusOk)
      tellOnce(DeviceEvent::Kind::status, fmt::format("the server says: status {} {}", item.code, item.text), out);
    return;
  }
  for (std::size_t h = 0; h < handCount; ++h) {
    const std::string& tool = settings_.tool[h];
    if (tool.empty()) continue;
    if (item.kind == Item::Kind::number) {
      if (item.name != tool + "Jaw") continue;
      if (std::isfinite(item.value) && std::abs(item.value) <= maxGripper)
        gripper_[h] = std::max(0.0, item.value);
      else
        tellOnce(DeviceEvent::Kind::malformed, fmt::format("{}: an opening that is not an angle", item.name), out);
      return;
    }
    if (item.name != tool) continue;
    out.samples.push_back({.deviceTime = item.time,
                           .hostTime = clock_(),
                           .sequence = sequence_[h]++,
                           .hand = static_cast<Hand>(h),
                           .position = item.position,
                           .orientation = item.orientation,
                           .gripper = gripper_[h],
                           .valid = item.kind == Item::Kind::pose && item.rotation});
    if (item.kind == Item::Kind::pose && !item.rotation)
      tellOnce(DeviceEvent::Kind::malformed,
               fmt::format("{}: a pose that is not finite, too far, or no rotation", item.name), out);
    break;
  }
  if (item.kind == Item::Kind::fault) tellOnce(DeviceEvent::Kind::malformed, item.text, out);
}

void OpenIgtLinkDevice::read(std::chrono::nanoseconds wait, DeviceInput& out) {
  if (wait.count() > 0 && !stream_.readable(wait)) return;
  const auto decode = [&](std::span<const std::byte> bytes) {
    return decoder_.take(bytes, [&](const Item& item) { take(item, out); });
  };
  if (!stream_.receiveAll(decode)) lose("disconnected: what the server sends is no OpenIGTLink", out);
}

OpenedDevice openOpenIgtLink(const DeviceRequest& request) {
  checkTools(request.tools);
  OpenIgtLinkSettings settings;
  settings.tool = request.tools;
  request.readAddress(settings.host, settings.port);
  return {std::make_unique<OpenIgtLinkDevice>(settings), nullptr};
}

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds lookPeriod{50};  // between two looks at `stop`
constexpr std::chrono::milliseconds rest{100};       // between two sendings of the last poses

bool send(TcpStream& client, const std::string& tool, const DeviceSample& sample) {
  if (tool.empty()) return true;
  const std::int64_t now =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  std::vector<std::byte> bytes = openigtlink::sensorMessage(tool + "Jaw", now, sample.gripper);
  const std::vector<std::byte> pose = openigtlink::transformMessage(tool, now, sample.position, sample.orientation);
  bytes.insert(bytes.end(), pose.begin(), pose.end());
  return client.send(bytes);
}

void serveClient(TcpStream client, const DeviceScript& motion, const OpenIgtLinkServerSettings& settings,
                 const std::atomic<bool>& stop) {
  const Clock::time_point begin = Clock::now();
  std::array<std::optional<DeviceSample>, handCount> last;
  std::array<std::byte, 4096> unread;  // what clients say is passed over
  for (const DeviceSample& sample : motion.samples) {
    const auto hand = static_cast<std::size_t>(sample.hand);
    const auto due = begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::nano>(
                                 static_cast<double>(sample.hostTime) / settings.speed));
    while (Clock::now() < due && !stop) std::this_thread::sleep_until(std::min(due, Clock::now() + lookPeriod));
    if (stop || !send(client, settings.tool[hand], sample)) return;
    client.receive(unread);
    last[hand] = sample;
  }
  while (client.open() && !stop) {
    std::this_thread::sleep_for(rest);
    for (std::size_t h = 0; h < handCount; ++h) {
      if (last[h]) send(client, settings.tool[h], *last[h]);
    }
    client.receive(unread);
  }
}

}  // namespace

void serveOpenIgtLink(const DeviceScript& motion, const OpenIgtLinkServerSettings& settings,
                      const std::atomic<bool>& stop, const std::function<void(const std::string&)>& tell) {
  TcpListener listener(settings.port);
  tell(fmt::format("listening on 127.0.0.1:{}", listener.port()));
  listener.serve(stop, settings.once, tell,
                 [&](TcpStream client) { serveClient(std::move(client), motion, settings, stop); });
}

}  // namespace calot::recorder
