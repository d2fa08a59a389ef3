// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/open_device.h"

#include <fmt/format.h>

#include <charconv>
#include <utility>

#include "recorder/errors.h"
#include "recorder/sources/devices/gamepad_device.h"
#include "recorder/sources/devices/null_device.h"
#include "recorder/sources/devices/openigtlink_device.h"
#include "recorder/sources/devices/scripted_device.h"

namespace calot::recorder {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw Error(ExitCode::usage, fmt::format("--device {}: {}", name.substr(0, 80), why));
}

// HOST, HOST:PORT, [IPv6]:PORT or nothing.
void readAddress(const std::string& name, std::string address, OpenIgtLinkSettings& out) {
  if (address.empty()) return;
  std::string port;
  if (address.front() == '[') {
    const std::size_t end = address.find(']');
    if (end == std::string::npos || (end + 1 < address.size() && address[end + 1] != ':'))
      refuse(name, "[HOST]:PORT is wanted");
    if (end + 1 < address.size()) port = address.substr(end + 2);
    if (end + 1 < address.size() && port.empty()) refuse(name, "a port is missing behind the colon");
    address = address.substr(1, end - 1);
  } else if (const std::size_t colon = address.find(':'); colon != std::string::npos) {
    port = address.substr(colon + 1);
    address = address.substr(0, colon);
    if (port.empty()) refuse(name, "a port is missing behind the colon");
  }
  if (address.empty() || address.size() > 253) refuse(name, "a host is missing: openigtlink:HOST:PORT");
  for (const char c : address) {
    if (c <= 0x20 || c >= 0x7f || c == '/') refuse(name, "the host is no name or address");
  }
  out.host = address;
  if (port.empty()) return;
  const auto [end, fault] = std::from_chars(port.data(), port.data() + port.size(), out.port);
  if (fault != std::errc() || end != port.data() + port.size() || out.port < 1 || out.port > 65535)
    refuse(name, "the port is no number from 1 to 65535");
}

void checkTools(const std::array<std::string, handCount>& tools) {
  if (tools[0].empty() && tools[1].empty()) throw Error(ExitCode::usage, "--tools: at least one hand needs a tool");
  if (tools[0] == tools[1]) throw Error(ExitCode::usage, "--tools: both hands have the same tool");
  for (const std::string& tool : tools) {
    if (tool.size() > openigtlink::longestName)
      throw Error(ExitCode::usage, fmt::format("--tools: a name has at most {} characters", openigtlink::longestName));
  }
}

}  // namespace

OpenedDevice openDevice(const std::string& name, const std::array<std::string, handCount>& tools) {
  const std::size_t colon = name.find(':');
  const std::string kind = name.substr(0, colon);
  const std::string rest = colon == std::string::npos ? "" : name.substr(colon + 1);
  if (colon != std::string::npos && rest.empty()) refuse(name, "something is missing behind the colon");
  OpenedDevice out;
  if (kind == "gamepad") {
    out.device = std::make_unique<GamepadDevice>(rest);
    return out;
  }
  if (kind == "openigtlink") {
    checkTools(tools);
    OpenIgtLinkSettings settings;
    settings.tool = tools;
    readAddress(name, rest, settings);
    out.device = std::make_unique<OpenIgtLinkDevice>(settings);
    return out;
  }
  out.tickClock = std::make_shared<TickClock>();
  const DeviceClock clock = [ticks = out.tickClock] { return ticks->now; };
  if (kind == "null" && rest.empty()) {
    out.device = std::make_unique<NullDevice>(clock);
  } else if (kind == "scripted") {
    if (rest.empty()) refuse(name, "a file is missing: scripted:FILE");
    out.device = std::make_unique<ScriptedDevice>(readDeviceScript(rest), clock);
  } else if (kind == "mouse") {
    refuse(name, "mouse and keyboard need a window: calot-trainer has one");
  } else {
    refuse(name, "no such device; there are gamepad[:NAME], openigtlink[:HOST[:PORT]], scripted:FILE and null");
  }
  return out;
}

std::vector<ListedDevice> listDevices() {
  std::vector<ListedDevice> out;
  std::vector<std::string> pads;
  std::string fault = "none is attached";
  try {
    pads = listGamepads();
  } catch (const Error& e) {
    fault = e.what();
  }
  out.reserve(pads.size() + 4);
  for (const std::string& pad : pads)
    out.push_back({"gamepad:" + pad, pad, true, "1 at a time", "3 + roll, jaw, buttons", "250"});
  if (pads.empty()) out.push_back({"gamepad", fault, false, "1 at a time", "3 + roll, jaw, buttons", "250"});
  out.push_back({"openigtlink:HOST:PORT",
                 fmt::format("a server's tracked tools; default localhost:{}", openigtlink::defaultPort), true, "2",
                 "6, jaw by SENSOR", "the server's"});
  out.push_back({"scripted:FILE", "plays a script or a kinematics file", true, "2", "6, jaw, buttons", "the file's"});
  out.push_back({"null", "never moves", true, "2", "none", "1000"});
  return out;
}

}  // namespace calot::recorder
