// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "recorder/sources/devices/camera/frame_source.h"
#include "recorder/sources/devices/camera/video_file.h"

namespace calot::recorder {

/// A camera of Video4Linux. The driver stamps frames on the host's monotonic clock and numbers them, so that latency
/// and missing frames are known. A camera that was unplugged is looked for every half second.
class LiveCamera final : public FrameSource {
 public:
  /// @param file /dev/videoN @param width, height that its lens was calibrated with; 0: 1280 x 720
  /// @throws Error (failure) where it is not there, gives neither YUYV nor motion JPEG, or not that size
  LiveCamera(std::string file, int width, int height);
  ~LiveCamera() override;

  FrameStatus next(std::chrono::nanoseconds wait, Frame& out) override;
  /// The driver's name for it, and its connection.
  [[nodiscard]] const std::string& card() const { return card_; }

  /// /dev/videoN that capture pictures, with the driver's name of them. Does not throw.
  static std::vector<std::array<std::string, 2>> list();

 private:
  [[nodiscard]] std::string start();
  void stop();
  bool convert(std::span<const std::uint8_t> bytes, GreyImage& out);

  struct Mapped {
    void* address = nullptr;
    std::size_t length = 0;
  };
  std::string card_;
  int handle_ = -1;
  bool compressed_ = false;
  std::size_t stride_ = 0;
  std::vector<Mapped> buffer_;
  GreyDecoder decoder_;
  std::int64_t lastNumber_ = -1, nextAttempt_ = 0;
};

}  // namespace calot::recorder
