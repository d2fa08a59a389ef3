// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/device_source.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/sources/pointing.h"
#include "sim/math/floating_point.h"
#include "sim/math/linear.h"

namespace calot::recorder {

DevicePump::DevicePump(Device& device, bool realTime) : device_(device) {
  if (realTime) thread_ = std::thread([this] { run(); });
}

DevicePump::~DevicePump() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  device_.close();
}

void DevicePump::run() {
  // A motor wants its command every millisecond; a device that only speaks is waited for longer.
  const std::chrono::milliseconds wait(device_.info().capabilities.actuated > 0 ? 1 : 20);
  DeviceInput input;
  Command command;
  while (!stop_) {
    while (commands_.pop(command)) obey(command);
    device_.poll(wait, input);
    for (DeviceEvent& event : input.events) events_.push(std::move(event));
    for (const DeviceSample& sample : input.samples) samples_.push(sample);
    input.events.clear();
    input.samples.clear();
    if (device_.ended()) ended_.store(true, std::memory_order_release);
  }
}

void DevicePump::drain(DeviceInput& out) {
  out.samples.clear();
  out.events.clear();
  if (!thread_.joinable()) {
    device_.poll(std::chrono::nanoseconds(0), out);
    ended_ = device_.ended();
    return;
  }
  DeviceEvent event;
  while (events_.pop(event)) out.events.push_back(std::move(event));
  DeviceSample sample;
  while (samples_.pop(sample)) out.samples.push_back(sample);
}

void DevicePump::command(const Command& command) {
  if (thread_.joinable())
    commands_.push(command);
  else
    obey(command);
}

void DevicePump::obey(const Command& command) {
  if (const auto* wrench = std::get_if<Wrench>(&command.what))
    device_.setWrench(command.hand, *wrench);
  else
    device_.setOut(command.hand, std::get<HandStart>(command.what));
}

namespace {

constexpr std::int64_t tickNanoseconds = 1'000'000;
constexpr std::int64_t secondHand = 500'000'000;  // ns that the other hand is waited for
constexpr std::size_t freshRoom = 1024;
constexpr std::size_t mostTold = 100;
constexpr double sameJaw = 1e-3;  // rad
// Less is a hand's trembling, or noise of a device.
constexpr double motionDistance = 2e-3;  // m
constexpr double motionAngle = 0.1;      // rad, of the shaft and of the jaws
constexpr std::uint8_t actingButtons =
    button::cutPedal | button::coagulatePedal | button::fire | button::retractMore | button::retractLess;

/// Are these poses of a hand that has moved, worked its jaw or pressed something in between?
bool isMotion(const DeviceSample& from, const DeviceSample& to) {
  const double halfAngle = std::min(1.0, std::abs(from.orientation.dot(to.orientation)));  // its cosine
  return (to.position - from.position).norm() > motionDistance || halfAngle < std::cos(0.5 * motionAngle) ||
         std::abs(to.gripper - from.gripper) > motionAngle || to.buttons != from.buttons;
}

}  // namespace

TakeOver::TakeOver(const HandStart& start) : kept_(start), keepsJaw_(true), keepsLock_(true), down_(actingButtons) {}

void TakeOver::apply(InstrumentSample& sample) {
  down_ = static_cast<std::uint8_t>(down_ & sample.buttons);
  sample.buttons = static_cast<std::uint8_t>(sample.buttons & ~down_);
  const bool locked = (sample.buttons & button::lock) != 0;
  keepsLock_ = keepsLock_ && locked != kept_.locked;
  if (keepsLock_) sample.buttons = static_cast<std::uint8_t>(sample.buttons ^ button::lock);
  const double jaw = sample.jaw;
  const bool passed = jawBefore_ && (*jawBefore_ < kept_.jaw) != (jaw < kept_.jaw);
  keepsJaw_ = keepsJaw_ && !passed && std::abs(jaw - kept_.jaw) > sameJaw;
  jawBefore_ = jaw;
  if (keepsJaw_) sample.jaw = kept_.jaw;
}

DeviceSource::DeviceSource(std::unique_ptr<Device> device, const SceneDescription& scene, DeviceSourceSettings settings)
    : settings_(std::move(settings)),
      camera_(scene.camera),
      ticksPerStep_(scene.ticksPerStep),
      device_(std::move(device)),
      pump_(*device_, !settings_.tickClock) {
  const DeviceInfo& info = device_->info();
  provenance_.kind = info.operatorKind;
  provenance_.device = info.name;
  if (info.operatorKind == OperatorKind::performer) {
    provenance_.profile = info.name;
    provenance_.profileVersion = std::string("1");
  }
  provenance_.sourceFile = info.sourceFile;
  provenance_.sourceSha256 = info.sourceSha256;
  if (settings_.calibration) provenance_.calibration = calibrationText(*settings_.calibration, true);
  for (std::size_t h = 0; h < handCount; ++h) {
    const auto of = [&](std::size_t which) {
      return settings_.calibration && settings_.calibration->hand[which] ? &*settings_.calibration->hand[which]
                                                                         : nullptr;
    };
    HandState state{DeviceMapping(scene.hands[h], scene.camera, of(h), of(1 - h))};
    state.held.position = scene.hands[h].home;
    state.held.orientation = pointing(scene.hands[h].port, scene.hands[h].home);
    state.held.instrument = InstrumentKind::none;
    state.held.valid = false;
    hand_.push_back(state);
  }
  fresh_.reserve(freshRoom);
}

std::int64_t DeviceSource::now() const {
  return settings_.tickClock ? settings_.tickClock->now : monotonicNanoseconds();
}

void DeviceSource::gather() {
  pump_.drain(input_);
  ended_ = pump_.ended();
  for (const DeviceEvent& event : input_.events) {
    if (counts_.told.size() < mostTold) counts_.told.push_back(event.text);
    if (event.kind == DeviceEvent::Kind::disconnected) {
      if (lost_.empty() && begun_) {
        ++counts_.losses;
        failed_ = failed_ || settings_.mode == Mode::assessment;
        for (HandState& hand : hand_) hand.anchorAgain = hand.mapping.anchored();
      }
      lost_ = event.text;
    } else if (event.kind == DeviceEvent::Kind::connected) {
      // A failed source stays failed, and keeps its reason.
      if (!failed_) lost_.clear();
    }
  }
  for (const DeviceSample& sample : input_.samples) {
    ++counts_.samples;
    if (!sample.valid)
      ++counts_.invalid;
    else
      hand_[static_cast<std::size_t>(sample.hand)].newest = sample;
  }
  if (begun_) fresh_.insert(fresh_.end(), input_.samples.begin(), input_.samples.end());
}

/// Drops samples from before the attempt, except the one that its first tick uses.
void DeviceSource::beginAttempt() {
  gather();
  begun_ = true;
  for (const HandState& hand : hand_) {
    if (hand.newest) fresh_.push_back(*hand.newest);
  }
}

void DeviceSource::keepRaw(std::uint64_t tick) {
  for (const DeviceSample& sample : fresh_) {
    const HandState& hand = hand_[static_cast<std::size_t>(sample.hand)];
    raw_.put({sample, tick, hand.used && sample.valid && sample.sequence == hand.newest->sequence});
  }
  fresh_.clear();
}

void DeviceSource::waitForFirst(double seconds, const std::atomic<bool>* stop) {
  const std::int64_t begin = now();
  std::int64_t first = -1;
  for (;;) {
    gather();
    const auto seen =
        std::count_if(hand_.begin(), hand_.end(), [](const HandState& h) { return h.newest.has_value(); });
    if (seen >= device_->info().capabilities.hands) return;
    const std::int64_t t = now();
    if (seen > 0 && first < 0) first = t;
    if (first >= 0 && t - first >= secondHand) return;
    if (stop != nullptr && *stop)
      throw Error(ErrorKind::failure, fmt::format("{}: stopped before the first sample", provenance_.device));
    if (ended_ || static_cast<double>(t - begin) >= 1e9 * seconds) {
      throw Error(ErrorKind::failure, fmt::format("{}: no valid sample of any hand{}: {}", provenance_.device,
                                                  ended_ ? "" : fmt::format(" within {:g} s", seconds),
                                                  lost_.empty() ? device_->info().detail : lost_));
    }
    if (settings_.tickClock)
      settings_.tickClock->now += tickNanoseconds;
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

bool DeviceSource::moved() {
  gather();
  if (settings_.tickClock) settings_.tickClock->now += tickNanoseconds;
  bool any = ended_;
  for (HandState& hand : hand_) {
    if (!hand.newest) continue;
    if (!hand.still) hand.still = hand.newest;
    any = any || isMotion(*hand.still, *hand.newest);
  }
  return any;
}

/// Jaw and lock stay as they are held until the device takes over.
void DeviceSource::keepHeld(std::size_t hand) {
  const InstrumentSample& held = hand_[hand].held;
  const HandStart kept{held.jaw, (held.buttons & button::lock) != 0};
  hand_[hand].takeOver = TakeOver(kept);
  pump_.setOut(static_cast<Hand>(hand), kept);
}

void DeviceSource::fill(std::size_t h, InstrumentSample& out) {
  HandState& hand = hand_[h];
  hand.used = false;
  if (hand.newest) {
    const DeviceSample& sample = *hand.newest;
    const bool fresh = lost_.empty() && static_cast<double>(now() - sample.hostTime) <= 1e9 * settings_.staleAfter;
    const bool clutch = (sample.buttons & clutchButton) != 0;
    if (fresh) {
      if (!hand.mapping.anchored() && !hand.placed) {
        hand.mapping.anchorAtHome(sample);
      } else if (!hand.mapping.anchored() || hand.anchorAgain || (hand.clutched && !clutch)) {
        hand.mapping.anchor(sample, hand.held.position, hand.held.orientation);
      }
      if (hand.anchorAgain) keepHeld(h);
      hand.anchorAgain = false;
      hand.clutched = clutch;
      if (!clutch) {
        hand.held = hand.mapping.map(sample);
        hand.takeOver.apply(hand.held);
      }
      hand.used = !clutch;
    }
    hand.held.valid = fresh;
  }
  out = hand.held;
  pullTrigger(hand, out);
}

/// Jaws that stand open would else close a clip in every step: of the ticks that a press lasts, one step sees these.
void DeviceSource::pullTrigger(HandState& hand, InstrumentSample& out) const {
  const bool down = (out.buttons & button::fire) != 0;
  if (down && !hand.trigger) hand.triggered = ticksPerStep_;
  hand.trigger = down;
  out.buttons = static_cast<std::uint8_t>(out.buttons & ~button::fire);
  if (hand.triggered == 0) return;
  --hand.triggered;
  out.buttons |= button::fire;
}

bool DeviceSource::next(std::uint64_t tick, TickSamples& out) {
  const FloatingPointScope environment;
  if (begun_)
    gather();
  else
    beginAttempt();
  if (ended_ && input_.samples.empty()) return false;
  TickSamples samples;
  for (std::size_t h = 0; h < handCount; ++h) fill(h, samples.hand[h]);
  keepRaw(tick);
  samples.camera = camera_;
  out = roundedToGrid(samples);
  if (settings_.tickClock) settings_.tickClock->now += tickNanoseconds;
  return true;
}

SourceStatus DeviceSource::status() {
  if (!lost_.empty() && settings_.mode == Mode::assessment) failed_ = true;
  if (!lost_.empty() && !failed_) {
    if (settings_.tickClock) settings_.tickClock->now += tickNanoseconds;
    gather();
  }
  if (failed_) return SourceStatus::failed;
  return lost_.empty() ? SourceStatus::ok : SourceStatus::paused;
}

void DeviceSource::rest() {
  gather();
  fresh_.clear();
  for (HandState& hand : hand_) hand.anchorAgain = hand.mapping.anchored();
}

void DeviceSource::setOutFrom(const TickSamples& start) {
  for (std::size_t h = 0; h < handCount; ++h) {
    const InstrumentSample& from = start.hand[h];
    if (from.instrument == InstrumentKind::none) continue;
    hand_[h].held.position = from.position;
    hand_[h].held.orientation = from.orientation;
    hand_[h].held.jaw = from.jaw;
    hand_[h].held.buttons = from.buttons & button::lock;
    hand_[h].placed = true;
    keepHeld(h);
  }
}

void DeviceSource::feedback(const std::array<Wrench, handCount>& inWorld) {
  if (device_->info().capabilities.actuated == 0) return;
  for (std::size_t h = 0; h < handCount; ++h) {
    pump_.setWrench(static_cast<Hand>(h),
                    {hand_[h].mapping.inDevice(inWorld[h].force), hand_[h].mapping.inDevice(inWorld[h].torque)});
  }
}

}  // namespace calot::recorder
