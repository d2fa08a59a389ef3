// SPDX-License-Identifier: GPL-3.0-or-later
// Request behind "camera:".
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "recorder/sources/devices/camera/frame_source.h"
#include "recorder/sources/devices/device.h"

namespace calot::recorder {

struct CameraRequest {
  std::vector<std::string> cameras;  ///< one or two: /dev/videoN, or films
  bool live = false;
  bool paced = false;  ///< films come in real time, as cameras' pictures do
  std::string keys;    ///< input device of the pedals, or empty
};

/// "0", "/dev/video0", "FILM", "FILM,FILM", "paced,FILM", "0,2,keys=/dev/input/event3".
/// @throws Error (invalid)
CameraRequest parseCameraRequest(const DeviceRequest& request);

/// Identity of live cameras, from what their drivers call them.
std::string cameraIdentity(const std::vector<std::string>& cards);

/// @throws Error (damaged) naming the file
std::vector<std::unique_ptr<FrameSource>> openFilmSources(const std::vector<std::string>& files);

/// A film that comes as a camera's pictures do: each at its time by the host's clock, from the first call on, and
/// dropped where nobody took it before the one after the next was due. So the work beside a camera is measured without
/// one.
class PacedFilm final : public FrameSource {
 public:
  PacedFilm(std::unique_ptr<FrameSource> film, DeviceClock clock)
      : FrameSource(film->name(), film->width(), film->height(), film->rate()),
        film_(std::move(film)),
        clock_(std::move(clock)),
        period_(static_cast<std::int64_t>(1e9 / film_->rate())) {}

  FrameStatus next(std::chrono::nanoseconds wait, Frame& out) override;
  [[nodiscard]] std::string reason() const override { return film_->reason(); }

 private:
  std::unique_ptr<FrameSource> film_;
  DeviceClock clock_;
  std::int64_t period_;
  Frame pending_;
  bool held_ = false;        ///< pending_ is a frame that is not due yet
  std::int64_t begin_ = -1;  ///< of the film, by the clock
};

}  // namespace calot::recorder
