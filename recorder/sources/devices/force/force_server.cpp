// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/force/force_server.h"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>
#include <utility>

namespace calot::recorder {
namespace {

constexpr double step = 2e-5;  // s

double onGrid(double value, double quantum) { return quantum > 0.0 ? quantum * std::round(value / quantum) : value; }

}  // namespace

SimulatedHand::SimulatedHand(const SimulatedHandModel& model, const Vec3& position)
    : model_(model), position_(position), hand_(position), intended_(position) {}

void SimulatedHand::advance(double seconds, const Vec3& force, const Vec3& intended) {
  const int steps = std::max(1, static_cast<int>(std::lround(seconds / step)));
  const double h = seconds / steps;
  const Vec3 start = intended_;
  const Vec3 pace = (intended - start) / seconds;
  for (int i = 1; i <= steps; ++i) {
    intended_ = start + (h * i) * pace;
    const Vec3 grip = model_.gripStiffness * (hand_ - position_) + model_.gripDamping * (handVelocity_ - velocity_);
    const Vec3 arm = model_.armStiffness * (intended_ - hand_) + model_.armDamping * (pace - handVelocity_);
    Vec3 speed = velocity_ + (h / model_.deviceMass) * (force + grip - model_.deviceDamping * velocity_);
    const double most = h * model_.deviceFriction / model_.deviceMass;
    const double size = speed.norm();
    const Vec3 slowed = size > most ? Vec3((1.0 - most / size) * speed) : Vec3(Vec3::Zero());
    const Vec3 way = h * slowed;
    dissipated_ += model_.deviceDamping * velocity_.dot(way) + model_.deviceFriction * way.norm();
    work_ += force.dot(way);
    velocity_ = slowed;
    position_ += way;
    handVelocity_ += (h / model_.armMass) * (arm - grip);
    hand_ += h * handVelocity_;
  }
  intended_ = intended;
}

Vec3 SimulatedHand::measured() const {
  Vec3 out;
  for (int k = 0; k < 3; ++k) out[k] = onGrid(position_[k], model_.encoderQuantum);
  return out;
}

Vec3 SimulatedHand::motorForce(const Vec3& command) const {
  Vec3 out = command;
  const double size = out.norm();
  if (!out.allFinite()) return Vec3::Zero();
  if (size > model_.maxForce) out *= model_.maxForce / size;
  // Towards zero, so that the limit holds.
  for (int k = 0; k < 3; ++k) {
    if (model_.motorQuantum > 0.0) out[k] = model_.motorQuantum * std::trunc(out[k] / model_.motorQuantum);
  }
  return out;
}

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds patience{50};  // between two looks at `stop`
constexpr std::chrono::seconds greeting{1};
constexpr double periodSeconds = 0.001;              // s
constexpr double watchdogFall = 0.02;                // s, over which the motors go off by themselves
constexpr std::chrono::milliseconds mostBehind{20};  // a late server does not catch up on more

}  // namespace

IntendedPath::IntendedPath(const DeviceScript& script, Hand hand) {
  for (const DeviceSample& s : script.samples) {
    if (s.hand == hand && s.valid) samples_.push_back(s);
  }
}

DeviceSample IntendedPath::at(double seconds) const {
  DeviceSample out;
  if (samples_.empty()) {
    const double turn = 2.0 * std::numbers::pi * seconds;
    const double reach = 0.5 - 0.5 * std::cos(0.25 * turn);
    out.position = Vec3(0.003 * std::sin(0.5 * turn), 0.003 * std::cos(0.5 * turn) - 0.003, 0.065 * reach);
    return out;
  }
  const auto time = static_cast<std::int64_t>(1e9 * seconds);
  const auto after = std::upper_bound(samples_.begin(), samples_.end(), time,
                                      [](std::int64_t t, const DeviceSample& s) { return t < s.hostTime; });
  const DeviceSample& a = after == samples_.begin() ? samples_.front() : *(after - 1);
  out = a;
  if (after == samples_.begin() || after == samples_.end()) return out;
  const DeviceSample& b = *after;
  const double share = static_cast<double>(time - a.hostTime) / static_cast<double>(b.hostTime - a.hostTime);
  out.position += share * (b.position - a.position);
  out.orientation = a.orientation.slerp(share, b.orientation);
  out.gripper += share * (b.gripper - a.gripper);
  return out;
}

ForceServer::ForceServer(const DeviceScript* motion, const ForceServerSettings& settings)
    : settings_(settings), listener_(settings_.port) {
  hello_.hands = settings_.hands;
  hello_.name = "simulated force device";
  hello_.serial = "sim-1";
  TankModel& force = hello_.handle.force;
  force.maxEffort = settings_.hand.maxForce;
  force.damping = settings_.hand.deviceDamping;
  force.friction = settings_.hand.deviceFriction;
  force.quantum = settings_.hand.encoderQuantum;
  for (std::size_t h = 0; h < handCount; ++h) {
    if ((settings_.hands & (1U << h)) == 0) continue;
    Handle handle;
    handle.hand = static_cast<Hand>(h);
    if (motion != nullptr) handle.path = IntendedPath(*motion, handle.hand);
    handles_.push_back(std::move(handle));
  }
}

bool ForceServer::greet(TcpStream& client, const std::atomic<bool>& stop,
                        const std::function<void(const std::string&)>& tell) {
  client.send(forcewire::encode(hello_));
  const Clock::time_point until = Clock::now() + greeting;
  std::array<std::byte, 4096> buffer;
  while (client.open() && frames_.empty() && !stop && Clock::now() < until) {
    if (!client.readable(patience)) continue;
    const std::size_t n = client.receive(buffer);
    if (decoder_.take(std::span(buffer.data(), n), frames_)) continue;
    tell("what a client sends is not the protocol: " + decoder_.fault());
    return false;
  }
  if (frames_.empty()) return false;
  const auto* welcome = std::get_if<forcewire::Welcome>(&frames_.front());
  if (welcome == nullptr || welcome->version != forcewire::version) {
    client.send(forcewire::encode(forcewire::Fault{fmt::format("version {} is spoken here", forcewire::version)}));
    return false;
  }
  frames_.erase(frames_.begin());
  return true;
}

bool ForceServer::receive(TcpStream& client, double now) {
  std::array<std::byte, 16384> buffer;
  const std::size_t n = client.receive(buffer);
  if (!decoder_.take(std::span(buffer.data(), n), frames_)) {
    client.send(forcewire::encode(forcewire::Fault{decoder_.fault()}));
    return false;
  }
  for (const forcewire::Frame& frame : std::exchange(frames_, {})) {
    if (std::holds_alternative<forcewire::End>(frame)) return false;
    const auto* wrench = std::get_if<forcewire::WrenchFrame>(&frame);
    if (wrench == nullptr) continue;
    for (Handle& handle : handles_) {
      if (handle.hand != wrench->hand) continue;
      handle.heard = now;
      handle.coming.push_back({now + settings_.delay, wrench->number, wrench->wrench});
    }
  }
  return client.open();
}

forcewire::Pose ForceServer::tick(Handle& handle, double now) const {
  const DeviceSample wish = handle.path.at(now);
  // The interval that ends now was spent under the wrench that was in force.
  const double silent = now - handle.heard - 0.001 * hello_.watchdog;
  const double share = std::clamp(1.0 - silent / watchdogFall, 0.0, 1.0);
  const Vec3 force = handle.simulated->motorForce(share * handle.now.wrench.force);
  handle.simulated->advance(periodSeconds, force, wish.position);
  handle.maxForce = std::max(handle.maxForce, force.norm());
  forcewire::Pose pose;
  pose.hand = handle.hand;
  pose.buttons = wish.buttons;
  pose.number = handle.now.number;
  pose.sequence = handle.sequence++;
  pose.deviceTime = static_cast<std::int64_t>(std::llround(1e9 * now));
  pose.position = handle.simulated->measured();
  pose.orientation = wish.orientation.normalized();
  pose.gripper = wish.gripper;
  pose.shown.force = force;
  while (!handle.coming.empty() && handle.coming.front().at <= now + 1e-9) {
    handle.now = handle.coming.front();
    handle.coming.erase(handle.coming.begin());
  }
  return pose;
}

void ForceServer::serve(TcpStream client, const std::atomic<bool>& stop,
                        const std::function<void(const std::string&)>& tell) {
  decoder_.reset();
  frames_.clear();
  if (!greet(client, stop, tell)) return;
  for (Handle& handle : handles_) {
    handle.simulated.emplace(settings_.hand, handle.path.at(0.0).position);
    handle.coming.clear();
    handle.now = {};
    handle.heard = handle.maxForce = 0.0;
    handle.sequence = 0;
  }
  Clock::time_point due = Clock::now();
  std::vector<std::byte> bytes;
  for (std::uint64_t k = 1; !stop; ++k) {
    due += std::chrono::milliseconds(1);
    if (Clock::now() - due > mostBehind) due = Clock::now();
    std::this_thread::sleep_until(due);
    const double now = periodSeconds * static_cast<double>(k);
    if (!receive(client, now)) break;
    bytes.clear();
    for (Handle& handle : handles_) {
      const std::vector<std::byte> frame = forcewire::encode(tick(handle, now));
      bytes.insert(bytes.end(), frame.begin(), frame.end());
    }
    if (!client.send(bytes)) break;
  }
  if (stop) client.send(forcewire::encode(forcewire::End{}));
  for (const Handle& handle : handles_) {
    tell(fmt::format("{} hand: {} poses, at most {:.2f} N shown", handNames[static_cast<std::size_t>(handle.hand)],
                     handle.sequence, handle.maxForce));
  }
}

void ForceServer::run(const std::atomic<bool>& stop, const std::function<void(const std::string&)>& tell) {
  listener_.serve(stop, settings_.once, tell, [&](TcpStream client) { serve(std::move(client), stop, tell); });
}

}  // namespace calot::recorder
