// SPDX-License-Identifier: GPL-3.0-or-later
// `--device camera`: films or live cameras by name.
#include "recorder/sources/devices/camera/camera_device.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cstring>
#include <sstream>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/sources/devices/calibration.h"
#include "recorder/sources/devices/camera/frame_source.h"
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
  if (!file_.valid()) {
    throw Error(
        ErrorKind::failure, Where{file},
        fmt::format("the keyboard cannot be read: {} (members of the group \"input\" may)", std::strerror(errno)));
  }
}

bool PedalKeys::read() {
  const auto take = [this](const input_event& e) {
    // 0 up, 1 down, 2 repeats
    if (e.type == EV_KEY && e.code < down_.size()) down_[e.code] = e.value != 0;
  };
  if (file_.valid() && readEvents(file_.get(), take)) return true;
  // Unplugged, or at its end: a pedal that nobody can let go would cut for ever.
  down_.fill(false);
  file_.close();
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
    // Simultaneous: nearer than half a period.
    if (!c.waiting || c.pending.time > time + period_ / 2) continue;
    c.waiting = false;
    missed = frames.empty() ? c.pending.missed : std::min(missed, c.pending.missed);
    frames.push_back({i, c.pending.time, c.detect(c.pending.image)});
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

namespace {

constexpr std::string_view keysMark = "keys=", pacedMark = "paced";

bool isNumber(const std::string& text) {
  return !text.empty() && text.size() <= 3 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// SHA-256 of a file of any size, which is mapped, not read into memory.
std::string sha256OfFile(const std::string& file) {
  const Descriptor handle(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat about {};
  void* address = MAP_FAILED;
  if (handle.valid() && fstat(handle.get(), &about) == 0 && about.st_size > 0)
    address = mmap(nullptr, static_cast<std::size_t>(about.st_size), PROT_READ, MAP_PRIVATE, handle.get(), 0);
  if (address == MAP_FAILED) throw Error(ErrorKind::damaged, Where{file}, "cannot be read");
  const auto size = static_cast<std::size_t>(about.st_size);
  std::string hash = sha256Hex({static_cast<const std::byte*>(address), size});
  munmap(address, size);
  return hash;
}

void requireLensSize(const FrameSource& source, const CameraLens& lens) {
  if (source.width() == lens.width && source.height() == lens.height) return;
  throw Error(ErrorKind::invalid, Where{source.name()},
              fmt::format("its pictures have {} x {} pixels, those of the calibrated camera {} x {}", source.width(),
                          source.height(), lens.width, lens.height),
              {Remedy::measureCalibration});
}

DeviceInfo cameraInfo(const std::string& identity) {
  DeviceInfo info;
  info.name = cameraKind.name;
  info.identity = identity;
  info.capabilities.hands = 2;
  info.capabilities.sensesGripper = true;
  return info;
}

OpenedDevice openCamera(const DeviceRequest& request) {
  const CameraRequest wanted = parseCameraRequest(request);
  if (request.calibration == nullptr || !request.calibration->camera)
    throw Error(
        ErrorKind::invalid,
        fmt::format("device \"{}\": a camera needs a calibration with its lens: without one, no length is known",
                    request.name.substr(0, 80)),
        {Remedy::measureCalibration});
  const Calibration& calibration = *request.calibration;
  const CameraRig& rig = *calibration.camera;
  if (wanted.cameras.size() != rig.cameras.size())
    request.refuse(
        fmt::format("{} cameras are named, the calibration covers {}", wanted.cameras.size(), rig.cameras.size()));
  std::unique_ptr<PedalKeys> keys;
  if (!wanted.keys.empty()) keys = std::make_unique<PedalKeys>(wanted.keys);
  if (!wanted.live) {
    if (wanted.paced) {
      return OpenedDevice{openFilms(wanted.cameras, rig, calibration.identity, monotonicNanoseconds, true), nullptr};
    }
    auto ticks = std::make_shared<TickClock>();
    auto device = openFilms(wanted.cameras, rig, calibration.identity, [ticks] { return ticks->now; });
    return OpenedDevice{std::move(device), ticks};
  }
  std::vector<std::unique_ptr<FrameSource>> sources;
  std::vector<std::string> cards;
  for (std::size_t i = 0; i < wanted.cameras.size(); ++i) {
    sources.push_back(openLiveCamera(wanted.cameras[i], rig.cameras[i].lens.width, rig.cameras[i].lens.height));
    cards.push_back(sources.back()->card());
  }
  DeviceInfo info = cameraInfo(cameraIdentity(cards));
  info.detail = fmt::format("{}", fmt::join(wanted.cameras, ", "));
  return OpenedDevice{
      std::make_unique<CameraDevice>(std::move(sources), rig, std::move(info), monotonicNanoseconds, std::move(keys)),
      nullptr};
}

std::vector<ListedDevice> listCameras() {
  std::vector<ListedDevice> out;
  for (const auto& [file, card] : listLiveCameras())
    out.push_back({fmt::format("camera:{}", file.substr(std::string("/dev/video").size())), card, true, "2", "6, jaw",
                   "the camera's"});
  if (out.empty())
    out.push_back({"camera", "no camera is attached; camera:FILM plays a film", false, "2", "6, jaw", "the film's"});
  return out;
}

}  // namespace

std::string cameraIdentity(const std::vector<std::string>& cards) {
  return fmt::format("camera:{}", fmt::join(cards, "+")).substr(0, 200);
}

CameraRequest parseCameraRequest(const DeviceRequest& request) {
  CameraRequest out;
  std::istringstream parts(request.argument);
  for (std::string part; std::getline(parts, part, ',');) {
    if (part.empty()) request.refuse("a name is missing beside a comma");
    if (part.starts_with(keysMark)) {
      out.keys = part.substr(keysMark.size());
      if (out.keys.empty()) request.refuse("keys= names no keyboard: keys=/dev/input/by-id/...");
      continue;
    }
    if (part == pacedMark) {
      out.paced = true;
      continue;
    }
    const bool live = isNumber(part) || part.starts_with("/dev/video");
    if (isNumber(part)) part = fmt::format("/dev/video{}", part);
    if (!out.cameras.empty() && live != out.live) request.refuse("a film and a live camera cannot be read together");
    if (std::find(out.cameras.begin(), out.cameras.end(), part) != out.cameras.end())
      request.refuse("one camera is named twice");
    out.live = live;
    out.cameras.push_back(part);
  }
  if (out.cameras.empty()) request.refuse("a camera's number or a film is missing: camera:0, camera:FILM.mkv");
  if (!out.live && !out.keys.empty()) request.refuse("keys= goes with live cameras: nobody's foot keeps a film's time");
  if (out.live && out.paced) request.refuse("a live camera has its own pace: \"paced\" is for films");
  if (out.cameras.size() > 2) request.refuse("at most two cameras are read");
  return out;
}

std::vector<std::unique_ptr<FrameSource>> openFilmSources(const std::vector<std::string>& files) {
  std::vector<std::unique_ptr<FrameSource>> out;
  out.reserve(files.size());
  for (const std::string& file : files) out.push_back(openFilmSource(file));
  return out;
}

std::unique_ptr<CameraDevice> openFilms(const std::vector<std::string>& files, const CameraRig& rig,
                                        const std::string& identity, DeviceClock clock, bool paced) {
  std::vector<std::unique_ptr<FrameSource>> sources = openFilmSources(files);
  if (paced)
    for (std::unique_ptr<FrameSource>& source : sources) source = std::make_unique<PacedFilm>(std::move(source), clock);
  DeviceInfo info = cameraInfo(identity);
  std::string hashes;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    requireLensSize(*sources[i], rig.cameras[i].lens);
    if (i > 0) info.sourceFile += ",";
    info.sourceFile += sources[i]->name();
    hashes += sha256OfFile(files[i]);
  }
  // One film: its hash; two: the hash of both hashes' text.
  info.sourceSha256 = files.size() == 1 ? hashes : sha256Hex(std::as_bytes(std::span(hashes)));
  info.detail = "plays " + info.sourceFile;
  info.operatorKind = OperatorKind::kinematics;
  info.capabilities.realTime = paced;
  return std::make_unique<CameraDevice>(std::move(sources), rig, std::move(info), std::move(clock));
}

constinit const DeviceKind cameraKind{
    .name = "camera",
    .usage = "camera:N[,N][,keys=KEYBOARD]|[paced,]FILM[,FILM]",
    .help = "printed handles before one or two cameras, or in films of them",
    .row = {"camera", "", "2", "6, jaw", "the camera's"},
    .list = listCameras,
    .open = openCamera,
};

FrameStatus PacedFilm::next(std::chrono::nanoseconds wait, Frame& out) {
  if (begin_ < 0) begin_ = clock_();
  std::uint64_t dropped = 0;
  for (;;) {
    if (!held_) {
      const FrameStatus status = film_->next(std::chrono::nanoseconds(0), pending_);
      if (status != FrameStatus::frame) return status;
      held_ = true;
    }
    const std::int64_t due = begin_ + pending_.time;
    if (clock_() < due && wait.count() > 0)
      std::this_thread::sleep_for(std::min(wait, std::chrono::nanoseconds(due - clock_())));
    const std::int64_t now = clock_();
    if (now < due) return FrameStatus::none;
    held_ = false;
    if (now < due + 2 * period_) {
      out = std::move(pending_);
      out.time = due;
      out.missed += dropped;
      return FrameStatus::frame;
    }
    dropped += 1 + pending_.missed;
  }
}

}  // namespace calot::recorder
