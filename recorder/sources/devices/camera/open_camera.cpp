// SPDX-License-Identifier: GPL-3.0-or-later
// `--device camera`: films or live cameras by name.

#include "recorder/sources/devices/camera/open_camera.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/sources/devices/calibration.h"
#include "recorder/sources/devices/camera/camera_device.h"
#include "recorder/sources/devices/camera/live_camera.h"
#include "recorder/sources/devices/camera/video_file.h"

namespace calot::recorder {
namespace {

constexpr std::string_view keysMark = "keys=", pacedMark = "paced";

bool isNumber(const std::string& text) {
  return !text.empty() && text.size() <= 3 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// SHA-256 of a file of any size, which is mapped, not read into memory.
std::string sha256OfFile(const std::string& file) {
  const int handle = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat about {};
  void* address = MAP_FAILED;
  if (handle >= 0 && fstat(handle, &about) == 0 && about.st_size > 0)
    address = mmap(nullptr, static_cast<std::size_t>(about.st_size), PROT_READ, MAP_PRIVATE, handle, 0);
  if (handle >= 0) ::close(handle);
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
        fmt::format("{} cameras are named, the calibration is of {}", wanted.cameras.size(), rig.cameras.size()));
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
    auto camera =
        std::make_unique<LiveCamera>(wanted.cameras[i], rig.cameras[i].lens.width, rig.cameras[i].lens.height);
    cards.push_back(camera->card());
    sources.push_back(std::move(camera));
  }
  DeviceInfo info = cameraInfo(cameraIdentity(cards));
  info.detail = fmt::format("{}", fmt::join(wanted.cameras, ", "));
  return OpenedDevice{
      std::make_unique<CameraDevice>(std::move(sources), rig, std::move(info), monotonicNanoseconds, std::move(keys)),
      nullptr};
}

std::vector<ListedDevice> listCameras() {
  std::vector<ListedDevice> out;
  for (const auto& [file, card] : LiveCamera::list())
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
  std::string rest = request.argument;
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    std::string part = rest.substr(0, comma);
    rest = comma < rest.size() ? rest.substr(comma + 1) : "";
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
  for (const std::string& file : files) out.push_back(std::make_unique<VideoFile>(file));
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
  // Of one film its hash; of two, that of both hashes' text.
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
