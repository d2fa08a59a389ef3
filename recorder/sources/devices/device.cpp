// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/device.h"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"

namespace calot::recorder {
namespace {
constexpr std::int64_t retryPeriod = 500'000'000;  // ns from one attempt to connect to the next
}

std::int64_t monotonicNanoseconds() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void DeviceRequest::refuse(const std::string& why) const {
  throw Error(ErrorKind::invalid, fmt::format("device \"{}\": {}", name.substr(0, 80), why), {Remedy::nameDevice});
}

void DeviceRequest::readAddress(std::string& host, int& port) const {
  if (argument.empty()) return;
  const bool bracketed = argument.front() == '[';
  const std::size_t end = bracketed ? argument.find(']') : argument.find(':');
  host = argument.substr(bracketed ? 1 : 0, bracketed ? end - 1 : end);
  const std::string rest = end == std::string::npos ? "" : argument.substr(bracketed ? end + 1 : end);
  if (bracketed && (end == std::string::npos || (!rest.empty() && rest.front() != ':')))
    refuse("[HOST]:PORT is expected");
  if (host.empty() || host.size() > 253)
    refuse(fmt::format("a host is missing: {}:HOST:PORT", name.substr(0, name.find(':'))));
  if (std::any_of(host.begin(), host.end(), [](char c) { return c <= 0x20 || c >= 0x7f || c == '/'; }))
    refuse("the host is not a name or address");
  if (rest.empty()) return;
  if (rest.size() == 1) refuse("a port is missing behind the colon");
  const auto [last, fault] = std::from_chars(rest.data() + 1, rest.data() + rest.size(), port);
  if (fault != std::errc() || last != rest.data() + rest.size() || port < 1 || port > 65535)
    refuse("the port is not a number from 1 to 65535");
}

void ReopeningDevice::connectFirst(const std::string& called) {
  if (const std::string fault = connect(); !fault.empty())
    throw Error(ErrorKind::failure, fmt::format("{}: {}", called, fault), {Remedy::listDevices});
}

void ReopeningDevice::poll(std::chrono::nanoseconds wait, DeviceInput& out) {
  if (!open_) return;
  if (!connected()) {
    const std::int64_t now = clock_();
    if (now < nextAttempt_) {
      std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(wait, std::chrono::milliseconds(20)));
      return;
    }
    nextAttempt_ = now + retryPeriod;
    std::string fault = connect();
    if (!fault.empty()) {
      if (fault != refusal_) tell(DeviceEvent::Kind::disconnected, fmt::format("{}: {}", info_.identity, fault), out);
      refusal_ = std::move(fault);
      return;
    }
  }
  if (!std::exchange(greeted_, true)) {
    const bool again = std::exchange(welcomed_, true);
    tell(DeviceEvent::Kind::connected, info_.identity + (again ? ": there again" : ": there"), out);
  }
  read(wait, out);
  if (greeted_ && !connected()) lose(gone_, out);
}

void ReopeningDevice::lose(const std::string& why, DeviceInput& out) {
  disconnect();
  nextAttempt_ = clock_() + retryPeriod;
  greeted_ = false;
  refusal_ = why;
  tell(DeviceEvent::Kind::disconnected, fmt::format("{}: {}", info_.identity, why), out);
}

void ReopeningDevice::close() {
  open_ = false;
  disconnect();
}

}  // namespace calot::recorder
