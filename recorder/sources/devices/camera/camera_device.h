// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

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
  ~PedalKeys();
  PedalKeys(const PedalKeys&) = delete;
  PedalKeys& operator=(const PedalKeys&) = delete;

  struct Hold {
    std::uint8_t buttons = 0;
    double jawRate = 0.0;  ///< opening (rad/s), negative: closing
  };
  /// Reads what came; never waits. @returns false where the keyboard is gone: nothing is held from then on
  bool read();
  [[nodiscard]] Hold hold(Hand hand) const;

 private:
  int file_ = -1;
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
  void close() override { open_ = false; }

 private:
  struct Camera {
    std::unique_ptr<FrameSource> source;
    Frame pending;
    bool waiting = false;  ///< `pending` is a frame
    FrameStatus status = FrameStatus::none;
    TagDetector detector;
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

}  // namespace calot::recorder
