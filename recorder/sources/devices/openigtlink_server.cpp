// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/openigtlink_server.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

namespace calot::recorder {
namespace {
using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds patience{50};  // between two looks at `stop`
constexpr std::chrono::milliseconds rest{100};     // between two sendings of the last poses
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
    while (Clock::now() < due && !stop) std::this_thread::sleep_until(std::min(due, Clock::now() + patience));
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
    std::optional<TcpStream> client = listener_.accept(patience);
    if (!client) continue;
    tell("a client is there");
    serve(std::move(*client), stop);
    tell("the client is gone");
    if (settings_.once) return;
  }
}

}  // namespace calot::recorder
