// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/sources/devices/openigtlink_device.h"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"

namespace calot::recorder {
namespace {

using openigtlink::Item;

constexpr std::int64_t between = 500'000'000;  // ns from one attempt to connect to the next
constexpr std::chrono::milliseconds patience{300};
constexpr std::size_t maxFaults = 16;  // kinds of fault told a connection
constexpr double maxGripper = 3.2;     // rad
constexpr int statusOk = 1;

// HOST, HOST:PORT, [IPv6]:PORT or nothing.
void readAddress(const DeviceRequest& request, OpenIgtLinkSettings& out) {
  std::string address = request.argument;
  if (address.empty()) return;
  std::string port;
  if (address.front() == '[') {
    const std::size_t end = address.find(']');
    if (end == std::string::npos || (end + 1 < address.size() && address[end + 1] != ':'))
      request.refuse("[HOST]:PORT is wanted");
    if (end + 1 < address.size()) port = address.substr(end + 2);
    if (end + 1 < address.size() && port.empty()) request.refuse("a port is missing behind the colon");
    address = address.substr(1, end - 1);
  } else if (const std::size_t colon = address.find(':'); colon != std::string::npos) {
    port = address.substr(colon + 1);
    address = address.substr(0, colon);
    if (port.empty()) request.refuse("a port is missing behind the colon");
  }
  if (address.empty() || address.size() > 253) request.refuse("a host is missing: openigtlink:HOST:PORT");
  for (const char c : address) {
    if (c <= 0x20 || c >= 0x7f || c == '/') request.refuse("the host is no name or address");
  }
  out.host = address;
  if (port.empty()) return;
  const auto [end, fault] = std::from_chars(port.data(), port.data() + port.size(), out.port);
  if (fault != std::errc() || end != port.data() + port.size() || out.port < 1 || out.port > 65535)
    request.refuse("the port is no number from 1 to 65535");
}

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
    : settings_(std::move(settings)), clock_(std::move(clock)) {
  info_.name = openIgtLinkKind.name;
  info_.identity = fmt::format("openigtlink:{}/{},{}", settings_.host, settings_.tool[0], settings_.tool[1]);
  info_.detail = fmt::format("server {}:{}, tools \"{}\" and \"{}\"", settings_.host, settings_.port, settings_.tool[0],
                             settings_.tool[1]);
  info_.capabilities.hands =
      static_cast<int>(!settings_.tool[0].empty()) + static_cast<int>(!settings_.tool[1].empty());
  info_.capabilities.sensesGripper = true;
}

void OpenIgtLinkDevice::close() {
  open_ = false;
  stream_.close();
}

void OpenIgtLinkDevice::connect(DeviceInput& out) {
  std::string fault;
  stream_ = TcpStream::connect(settings_.host, settings_.port, patience, fault);
  nextAttempt_ = clock_() + between;
  if (stream_.open()) {
    decoder_.reset();
    told_.clear();
    refusal_.clear();
    gripper_.fill(0.0);
    out.events.push_back({DeviceEvent::Kind::connected, clock_(),
                          fmt::format("openigtlink {}:{}: connected", settings_.host, settings_.port)});
  } else if (fault != refusal_) {
    refusal_ = fault;
    out.events.push_back({DeviceEvent::Kind::disconnected, clock_(),
                          fmt::format("openigtlink {}:{}: {}", settings_.host, settings_.port, fault)});
  }
}

void OpenIgtLinkDevice::lose(const std::string& why, DeviceInput& out) {
  stream_.close();
  nextAttempt_ = clock_() + between;
  out.events.push_back({DeviceEvent::Kind::disconnected, clock_(),
                        fmt::format("openigtlink {}:{}: {}", settings_.host, settings_.port, why)});
}

void OpenIgtLinkDevice::tellOnce(const std::string& fault, DeviceInput& out) {
  if (told_.size() >= maxFaults || !told_.insert(fault).second) return;
  out.events.push_back({DeviceEvent::Kind::malformed, clock_(), "openigtlink: " + fault});
}

void OpenIgtLinkDevice::take(const Item& item, DeviceInput& out) {
  if (item.kind == Item::Kind::unknown) return;
  if (item.kind == Item::Kind::status) {
    if (item.code != statusOk) {
      const std::string text = fmt::format("the server says: status {} {}", item.code, item.text);
      if (told_.size() < maxFaults && told_.insert(text).second)
        out.events.push_back({DeviceEvent::Kind::status, clock_(), "openigtlink: " + text});
    }
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
        tellOnce(fmt::format("{}: an opening that is no angle", item.name), out);
      return;
    }
    if (item.name != tool) continue;
    DeviceSample sample;
    sample.hand = static_cast<Hand>(h);
    sample.sequence = sequence_[h]++;
    sample.hostTime = clock_();
    sample.deviceTime = item.time;
    sample.valid = item.kind == Item::Kind::pose && item.rotation;
    sample.position = item.position;
    sample.orientation = item.orientation;
    sample.gripper = gripper_[h];
    out.samples.push_back(sample);
    if (item.kind == Item::Kind::pose && !item.rotation)
      tellOnce(fmt::format("{}: a pose that is not finite, too far, or no rotation", item.name), out);
    break;
  }
  if (item.kind == Item::Kind::fault) tellOnce(item.text, out);
}

void OpenIgtLinkDevice::poll(std::chrono::nanoseconds wait, DeviceInput& out) {
  if (!open_) return;
  if (!stream_.open()) {
    if (clock_() < nextAttempt_) {
      std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(wait, std::chrono::milliseconds(20)));
      return;
    }
    connect(out);
    if (!stream_.open()) return;
  }
  if (wait.count() > 0 && !stream_.readable(wait)) return;
  std::array<std::byte, 65536> buffer;
  // Bounded, so that a sender that never stops cannot hold the thread.
  for (int i = 0; i < 16; ++i) {
    const std::size_t n = stream_.receive(buffer);
    if (n == 0) break;
    if (!decoder_.take(std::span(buffer.data(), n), [&](const Item& item) { take(item, out); })) {
      lose("disconnected: what the server sends is no OpenIGTLink", out);
      return;
    }
  }
  if (!stream_.open()) lose("the server is gone", out);
}

constinit const DeviceKind openIgtLinkKind{
    .name = "openigtlink",
    .usage = "openigtlink[:HOST[:PORT]]",
    .help = "tracked tools of an OpenIGTLink server",
    .list =
        [] {
          return std::vector<ListedDevice>{
              {"openigtlink:HOST:PORT",
               fmt::format("a server's tracked tools; default localhost:{}", openigtlink::defaultPort), true, "2",
               "6, jaw by SENSOR", "the server's"}};
        },
    .open =
        [](const DeviceRequest& request) {
          checkTools(request.tools);
          OpenIgtLinkSettings settings;
          settings.tool = request.tools;
          readAddress(request, settings);
          return OpenedDevice{std::make_unique<OpenIgtLinkDevice>(settings), nullptr};
        },
};

namespace {
using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds lookPeriod{50};  // between two looks at `stop`
constexpr std::chrono::milliseconds rest{100};       // between two sendings of the last poses
}  // namespace

OpenIgtLinkServer::OpenIgtLinkServer(const DeviceScript& motion, OpenIgtLinkServerSettings settings)
    : motion_(motion), settings_(std::move(settings)), listener_(settings_.port) {}

bool OpenIgtLinkServer::send(TcpStream& client, const DeviceSample& sample) {
  const std::string& name = settings_.tool[static_cast<std::size_t>(sample.hand)];
  if (name.empty()) return true;
  const std::int64_t now =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  std::vector<std::byte> bytes = openigtlink::sensorMessage(name + "Jaw", now, sample.gripper);
  const std::vector<std::byte> pose = openigtlink::transformMessage(name, now, sample.position, sample.orientation);
  bytes.insert(bytes.end(), pose.begin(), pose.end());
  return client.send(bytes);
}

void OpenIgtLinkServer::serve(TcpStream client, const std::atomic<bool>& stop) {
  const Clock::time_point begin = Clock::now();
  std::array<std::optional<DeviceSample>, handCount> last;
  std::array<std::byte, 4096> unread;  // what clients say is passed over
  for (const DeviceSample& sample : motion_.samples) {
    const auto due = begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::nano>(
                                 static_cast<double>(sample.hostTime) / settings_.speed));
    while (Clock::now() < due && !stop) std::this_thread::sleep_until(std::min(due, Clock::now() + lookPeriod));
    if (stop || !send(client, sample)) return;
    client.receive(unread);
    last[static_cast<std::size_t>(sample.hand)] = sample;
  }
  while (client.open() && !stop) {
    std::this_thread::sleep_for(rest);
    for (const auto& sample : last) {
      if (sample) send(client, *sample);
    }
    client.receive(unread);
  }
}

void OpenIgtLinkServer::run(const std::atomic<bool>& stop, const std::function<void(const std::string&)>& tell) {
  while (!stop) {
    std::optional<TcpStream> client = listener_.accept(lookPeriod);
    if (!client) continue;
    tell("a client is there");
    serve(std::move(*client), stop);
    tell("the client is gone");
    if (settings_.once) return;
  }
}

}  // namespace calot::recorder
