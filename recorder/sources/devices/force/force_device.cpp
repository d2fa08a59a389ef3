// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/force/force_device.h"

#include <fmt/format.h>

#include <utility>

namespace calot::recorder {
namespace {

constexpr std::chrono::milliseconds connectPatience{300};
constexpr std::int64_t greetingPatience = 1'000'000'000;  // ns

}  // namespace

ForceDevice::ForceDevice(ForceDeviceSettings settings, DeviceClock clock)
    : ForceFeedbackDevice(std::move(clock)), settings_(std::move(settings)) {
  connectFirst(fmt::format("force device {}:{}", settings_.host, settings_.port));
  gone_ = "the device is gone";
  const forcewire::Hello& hello = *hello_;
  info_.name = forceKind.name;
  info_.identity = fmt::format("force:{}/{}", hello.name, hello.serial);
  info_.detail = fmt::format("{} ({}), at most {:g} N, at {}:{}", hello.name, hello.serial,
                             hello.handle.force.maxEffort, settings_.host, settings_.port);
  DeviceCapabilities& c = info_.capabilities;
  c.hands = 0;
  for (std::size_t h = 0; h < handCount; ++h) {
    if ((settings_.hands & hello.hands & (1U << h)) == 0) continue;
    output_[h].emplace(hello.handle);
    ++c.hands;
  }
  c.sensesGripper = true;
  c.actuated = hello.handle.torque.maxEffort > 0.0 ? 4 : 3;
  c.maxForce = hello.handle.force.maxEffort;
  c.maxTorque = hello.handle.torque.maxEffort;
  c.workspace = hello.workspace;
  c.rate = hello.rate;
}

std::string ForceDevice::connect() {
  std::string fault;
  stream_ = TcpStream::connect(settings_.host, settings_.port, connectPatience, fault);
  if (!stream_.open()) return fault;
  decoder_.reset();
  frames_.clear();
  toldInvalid_ = false;
  std::array<std::byte, 4096> buffer;
  const std::int64_t until = clock_() + greetingPatience;
  while (frames_.empty() && stream_.open() && clock_() < until) {
    if (!stream_.readable(std::chrono::milliseconds(20))) continue;
    const std::size_t n = stream_.receive(buffer);
    if (decoder_.take(std::span(buffer.data(), n), frames_)) continue;
    stream_.close();
    return "no force device: " + decoder_.fault();
  }
  const auto refuse = [this](std::string why) {
    stream_.send(forcewire::encode(forcewire::Fault{why}));
    stream_.close();
    return why;
  };
  if (frames_.empty()) return refuse("it does not say what it is");
  if (const auto* told = std::get_if<forcewire::Fault>(&frames_.front())) return refuse("it says: " + told->text);
  const auto* hello = std::get_if<forcewire::Hello>(&frames_.front());
  if (hello == nullptr) return refuse("its first frame is not a greeting");
  if (std::string wrong = forcewire::faultOf(*hello); !wrong.empty()) return refuse(std::move(wrong));
  if ((hello->hands & settings_.hands) == 0) return refuse("it does not have the requested hand");
  if (hello_ && (hello_->name != hello->name || hello_->serial != hello->serial || hello_->hands != hello->hands ||
                 hello_->handle.force.maxEffort != hello->handle.force.maxEffort))
    return refuse(fmt::format("another device answers there: {} ({})", hello->name, hello->serial));
  if (!hello_) hello_ = *hello;
  frames_.erase(frames_.begin());
  stream_.send(forcewire::encode(forcewire::Welcome{forcewire::version, settings_.hands}));
  return {};
}

void ForceDevice::take(const forcewire::Pose& pose, DeviceInput& out) {
  const auto h = static_cast<std::size_t>(pose.hand);
  if (!output_[h]) return;
  const std::int64_t now = clock_();
  DeviceSample sample;
  sample.deviceTime = pose.deviceTime;
  sample.hostTime = now;
  sample.sequence = sequence_[h]++;
  sample.hand = pose.hand;
  sample.valid = pose.valid && forcewire::isPose(pose);
  if (sample.valid) {
    sample.position = pose.position;
    sample.orientation = pose.orientation.normalized();
    sample.gripper = pose.gripper;
    sample.buttons = pose.buttons;
  } else if (pose.valid && !std::exchange(toldInvalid_, true)) {
    tell(DeviceEvent::Kind::malformed, info_.identity + ": a pose that is not finite, too far, or no rotation", out);
  }
  out.samples.push_back(sample);

  const HandleMeasurement measurement{.position = sample.position,
                                      .orientation = sample.orientation,
                                      .deviceTime = pose.deviceTime,
                                      .number = pose.number,
                                      .shown = sample.valid ? pose.shown : Wrench{},
                                      .valid = sample.valid,
                                      .clutched = (sample.buttons & clutchButton) != 0};
  const Wrench wrench = measured(h, measurement, now);
  stream_.send(forcewire::encode(forcewire::WrenchFrame{pose.hand, output_[h]->number(), pose.deviceTime, wrench}));
}

void ForceDevice::read(std::chrono::nanoseconds wait, DeviceInput& out) {
  if (wait.count() > 0 && frames_.empty() && !stream_.readable(wait)) return;
  if (!stream_.receiveAll([this](std::span<const std::byte> bytes) { return decoder_.take(bytes, frames_); })) {
    lose("disconnected: " + decoder_.fault(), out);
    return;
  }
  for (const forcewire::Frame& frame : std::exchange(frames_, {})) {
    if (const auto* pose = std::get_if<forcewire::Pose>(&frame)) {
      take(*pose, out);
    } else if (const auto* told = std::get_if<forcewire::Fault>(&frame)) {
      tell(DeviceEvent::Kind::status, fmt::format("{} says: {}", info_.identity, told->text), out);
    } else if (std::holds_alternative<forcewire::End>(frame)) {
      stream_.close();
      break;
    }
  }
}

constinit const DeviceKind forceKind{
    .name = "force",
    .usage = "force[:HOST[:PORT]]",
    .help = "a force device by Calot's own protocol; calot devices simulate plays one",
    .row = {"force:HOST:PORT", "a force device by Calot's own protocol; default localhost:18950", "2",
            "6, jaw, buttons; shows force", "1000"},
    .open =
        [](const DeviceRequest& request) {
          ForceDeviceSettings settings;
          if (request.hand) settings.hands = static_cast<std::uint8_t>(1U << static_cast<unsigned>(*request.hand));
          request.readAddress(settings.host, settings.port);
          return OpenedDevice{std::make_unique<ForceDevice>(std::move(settings)), nullptr};
        },
};

}  // namespace calot::recorder
