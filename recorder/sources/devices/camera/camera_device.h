// SPDX-License-Identifier: GPL-3.0-or-later
// Request behind "camera:".
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "recorder/base/files.h"
#include "recorder/sources/devices/camera/frame_source.h"
#include "recorder/sources/devices/camera/handle_tracker.h"
#include "recorder/sources/devices/device.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// Keys of a keyboard, or a foot switch, as pedals and jaws of both hands, from a Linux input device (evdev), which
/// reports presses and releases whichever window has the focus.
///
/// Left hand: Q opens the jaw, A closes it, left Alt locks, Z cuts, X coagulates, 1 fires. Right hand: P opens, L
/// closes, right Alt locks, comma cuts, dot coagulates, 0 fires. F1 and F2, as foot switches send them, cut and
/// coagulate with the right hand.
class PedalKeys {
 public:
  /// @param file /dev/input/eventN or a link to one
  /// @throws Error (failure) where it cannot be opened
  explicit PedalKeys(const std::string& file);

  struct Hold {
    std::uint8_t buttons = 0;
    double jawRate = 0.0;  ///< opening (rad/s), negative: closing
  };
  /// Reads what came; never waits. @returns false where the keyboard is gone: nothing is held from then on
  bool read();
  [[nodiscard]] Hold hold(Hand hand) const;

 private:
  Descriptor file_;
  std::array<bool, 256> down_{};
};

/// Two printed handles that one or two cameras watch. D is the first camera's frame, I a handle's
/// (marker_sheets.h). A frame gives a sample of each hand; it is invalid where no pose can be believed
/// (HandleTracker). Missing frames are missing numbers.
///
/// deviceTime is the exposure's time, on the clock of the frames; hostTime when the pose was there. With live cameras
/// both are the host's monotonic clock, so that their difference is the latency behind the exposure.
class CameraDevice final : public Device {
 public:
  /// @param sources as many as the rig has cameras, each with its lens' size
  /// @param clock with which files keep pace; live cameras use it to stamp samples
  CameraDevice(std::vector<std::unique_ptr<FrameSource>> sources, CameraRig rig, DeviceInfo info, DeviceClock clock,
               std::unique_ptr<PedalKeys> keys = nullptr);

  void poll(std::chrono::nanoseconds wait, DeviceInput& out) override;
  [[nodiscard]] bool connected() const override { return connected_; }
  [[nodiscard]] bool ended() const override { return ended_; }
  void setOut(Hand hand, const HandStart& start) override { jaw_[static_cast<std::size_t>(hand)] = start.jaw; }
  void close() override { open_ = false; }

 private:
  struct Camera {
    std::unique_ptr<FrameSource> source;
    Frame pending;
    bool waiting = false;  ///< `pending` is a frame
    FrameStatus status = FrameStatus::none;
    TagDetector detect = makeTagDetector();
  };
  [[nodiscard]] bool live() const { return info_.capabilities.realTime; }
  bool gather(std::chrono::nanoseconds wait, DeviceInput& out);
  void measure(std::int64_t time, DeviceInput& out);
  void put(Hand hand, const HandleSight& sight, std::uint64_t missed, std::int64_t host, DeviceInput& out);

  CameraRig rig_;
  std::vector<std::unique_ptr<Camera>> camera_;
  std::unique_ptr<PedalKeys> keys_;
  std::vector<HandleTracker> tracker_;
  std::array<std::uint64_t, handCount> sequence_{};
  std::array<double, handCount> jaw_{};
  std::array<std::uint32_t, handCount> faultsTold_{};  ///< a bit a fault
  std::int64_t origin_ = 0, period_ = 0;
  bool open_ = true, greeted_ = false, connected_ = false, ended_ = false;
};

/// Films as a device; the same samples every time, on the clock of ticks.
/// @param paced instead in real time, by the host's clock, as a live camera's (PacedFilm)
/// @throws Error: damaged, for a file; invalid, where its size is not the calibrated lens'
std::unique_ptr<CameraDevice> openFilms(const std::vector<std::string>& files, const CameraRig& rig,
                                        const std::string& identity, DeviceClock clock, bool paced = false);

extern const DeviceKind cameraKind;

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
