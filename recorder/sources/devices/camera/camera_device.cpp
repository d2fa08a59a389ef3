// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/sources/devices/camera/camera_device.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <algorithm>
#include <cstring>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/sources/devices/evdev.h"
#include "recorder/sources/devices/pointer_device.h"

namespace calot::recorder {
namespace {

constexpr double jawSpeedOfKeys = 1.8;  // rad/s, as by the trainer's keys

struct KeySet {
  int open, close, lock, cut, cutToo, coagulate, coagulateToo, fire, more, less;
};
constexpr std::array<KeySet, handCount> keySets{
    KeySet{KEY_Q, KEY_A, KEY_LEFTALT, KEY_Z, KEY_Z, KEY_X, KEY_X, KEY_1, KEY_2, KEY_3},
    KeySet{KEY_P, KEY_L, KEY_RIGHTALT, KEY_COMMA, KEY_F1, KEY_DOT, KEY_F2, KEY_0, KEY_9, KEY_8}};

}  // namespace

PedalKeys::PedalKeys(const std::string& file) : file_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
  if (file_ < 0) {
    throw Error(
        ErrorKind::failure, Where{file},
        fmt::format("the keyboard cannot be read: {} (members of the group \"input\" may)", std::strerror(errno)));
  }
}

PedalKeys::~PedalKeys() {
  if (file_ >= 0) ::close(file_);
}

bool PedalKeys::read() {
  const auto take = [this](const input_event& e) {
    // 0 up, 1 down, 2 repeats
    if (e.type == EV_KEY && e.code < down_.size()) down_[e.code] = e.value != 0;
  };
  if (file_ >= 0 && readEvents(file_, take)) return true;
  // Unplugged, or at its end: a pedal that nobody can let go would cut for ever.
  down_.fill(false);
  if (file_ >= 0) ::close(std::exchange(file_, -1));
  return false;
}

PedalKeys::Hold PedalKeys::hold(Hand hand) const {
  const KeySet& key = keySets[static_cast<std::size_t>(hand)];
  const auto is = [&](int code) { return down_[static_cast<std::size_t>(code)]; };
  Hold out;
  press(out.buttons, is(key.cut) || is(key.cutToo), button::cutPedal);
  press(out.buttons, is(key.coagulate) || is(key.coagulateToo), button::coagulatePedal);
  press(out.buttons, is(key.fire), button::fire);
  press(out.buttons, is(key.lock), button::lock);
  press(out.buttons, is(key.more), button::retractMore);
  press(out.buttons, is(key.less), button::retractLess);
  out.jawRate = jawSpeedOfKeys * between(is(key.open), is(key.close));
  return out;
}

namespace {

constexpr double largestGripper = 1.2;                // rad
constexpr std::chrono::milliseconds pairPatience(2);  // from look to look

}  // namespace

CameraDevice::CameraDevice(std::vector<std::unique_ptr<FrameSource>> sources, CameraRig rig, DeviceInfo info,
                           DeviceClock clock, std::unique_ptr<PedalKeys> keys)
    : Device(std::move(clock)), rig_(std::move(rig)), keys_(std::move(keys)) {
  info_ = std::move(info);
  double rate = sources.front()->rate();
  for (std::unique_ptr<FrameSource>& source : sources) {
    rate = std::max(rate, source->rate());
    camera_.push_back(std::make_unique<Camera>());
    camera_.back()->source = std::move(source);
  }
  period_ = static_cast<std::int64_t>(1e9 / rate);
  info_.capabilities.rate = rate;
  for (const Hand hand : {Hand::left, Hand::right}) tracker_.emplace_back(rig_, hand);
  origin_ = live() ? 0 : clock_();
}

/// Fills what each camera has next. @returns whether there is a frame
bool CameraDevice::gather(std::chrono::nanoseconds wait, DeviceInput& out) {
  bool any = false, gone = false, waited = false;
  std::size_t finished = 0;
  for (const std::unique_ptr<Camera>& c : camera_) {
    if (!c->waiting && c->status != FrameStatus::ended) {
      c->status = c->source->next(waited ? std::chrono::nanoseconds(0) : wait, c->pending);
      waited = true;
      c->waiting = c->status == FrameStatus::frame;
      if (c->waiting && c->pending.missed > 0)
        tell(DeviceEvent::Kind::status,
             fmt::format("{}: {} frames missing before {:.3f} s", c->source->name(), c->pending.missed,
                         1e-9 * static_cast<double>(c->pending.time)),
             out);
      if (c->status == FrameStatus::ended && !c->source->reason().empty())
        tell(DeviceEvent::Kind::malformed, c->source->reason(), out);
    }
    any = any || c->waiting;
    gone = gone || c->status == FrameStatus::lost;
    if (c->status == FrameStatus::ended) ++finished;
  }
  if (gone && connected_) {
    connected_ = false;
    for (const std::unique_ptr<Camera>& c : camera_) {
      if (c->status == FrameStatus::lost) {
        const std::string why = c->source->reason();
        tell(DeviceEvent::Kind::disconnected, why.empty() ? c->source->name() + ": unplugged" : why, out);
        break;
      }
    }
  } else if (!gone && !connected_ && any) {
    connected_ = true;
    tell(DeviceEvent::Kind::connected, info_.identity + (greeted_ ? ": there again" : ": there"), out);
    greeted_ = true;
  }
  ended_ = finished == camera_.size() && !any;
  return any;
}

void CameraDevice::put(Hand hand, const HandleSight& sight, std::uint64_t missed, std::int64_t host, DeviceInput& out) {
  const auto h = static_cast<std::size_t>(hand);
  sequence_[h] += missed;
  DeviceSample sample;
  sample.hand = hand;
  sample.sequence = sequence_[h]++;
  sample.deviceTime = sight.time;
  sample.hostTime = host;
  sample.valid = sight.fault == PoseFault::none;
  if (sample.valid) {
    sample.position = sight.pose.position;
    sample.orientation = sight.pose.orientation;
  } else if (const auto fault = static_cast<std::uint32_t>(sight.fault); (faultsTold_[h] >> fault & 1U) == 0) {
    faultsTold_[h] |= 1U << fault;
    tell(DeviceEvent::Kind::status,
         fmt::format("{} handle at {:.3f} s: {}", handNames[h], 1e-9 * static_cast<double>(sight.time),
                     wordsFor(sight.fault)),
         out);
  }
  if (sight.jaw) jaw_[h] = *sight.jaw;
  if (keys_) {
    const PedalKeys::Hold hold = keys_->hold(hand);
    sample.buttons = hold.buttons;
    jaw_[h] += hold.jawRate * 1e-9 * static_cast<double>(period_);
  }
  jaw_[h] = std::clamp(jaw_[h], 0.0, largestGripper);
  sample.gripper = jaw_[h];
  out.samples.push_back(sample);
}

void CameraDevice::measure(std::int64_t time, DeviceInput& out) {
  std::vector<SeenFrame> frames;
  std::uint64_t missed = 0;
  for (std::size_t i = 0; i < camera_.size(); ++i) {
    Camera& c = *camera_[i];
    // Of the same moment: nearer than half a period.
    if (!c.waiting || c.pending.time > time + period_ / 2) continue;
    c.waiting = false;
    missed = frames.empty() ? c.pending.missed : std::min(missed, c.pending.missed);
    frames.push_back({i, c.pending.time, c.detector.detect(c.pending.image)});
  }
  if (keys_ && !keys_->read()) {
    tell(DeviceEvent::Kind::malformed, "the keyboard of the pedals is gone: they are up", out);
    keys_.reset();
  }
  for (const Hand hand : {Hand::left, Hand::right}) {
    const HandleSight sight = tracker_[static_cast<std::size_t>(hand)].track(frames);
    put(hand, sight, missed, live() ? clock_() : origin_ + time, out);
  }
}

void CameraDevice::poll(std::chrono::nanoseconds wait, DeviceInput& out) {
  while (open_ && gather(wait, out)) {
    std::int64_t time = -1;
    for (const std::unique_ptr<Camera>& c : camera_) {
      if (c->waiting) time = time < 0 ? c->pending.time : std::min(time, c->pending.time);
    }
    if (!live() && origin_ + time > clock_()) return;
    // The other live camera's frame of the same moment may be on its way.
    if (live() && clock_() < time + period_ &&
        std::any_of(camera_.begin(), camera_.end(), [](const auto& c) { return c->status == FrameStatus::none; })) {
      if (wait.count() == 0) return;
      wait = std::min<std::chrono::nanoseconds>(wait, pairPatience);
      continue;
    }
    measure(time, out);
    wait = std::chrono::nanoseconds(0);
  }
}

}  // namespace calot::recorder
