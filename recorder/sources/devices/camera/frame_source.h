// SPDX-License-Identifier: GPL-3.0-or-later
// Where a camera's pictures come from.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace calot::recorder {

/// A picture of a camera in grey, rows from the top without gaps.
struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

struct SeenTag {
  int id = 0;
  int hamming = 0;                        ///< bits that were corrected
  double margin = 0.0;                    ///< contrast of its bits (grey levels)
  std::array<Eigen::Vector2d, 4> corner;  ///< pixels, in the order of TagPlace::corner
};

/// Finds tags of the family 36h11 (AprilTag 3: Krogius, Haggenmiller, Olson 2019, "Flexible layouts for fiducial tags",
/// IROS) with at most one corrected bit and clear contrast, in the order of their numbers. A number that is seen twice
/// is left out: one of the two is false, and which cannot be said. One thread, and the same result every time.
using TagDetector = std::function<std::vector<SeenTag>(const GreyImage& image)>;
TagDetector makeTagDetector();

struct Frame {
  GreyImage image;
  std::int64_t time = 0;     ///< exposure of the middle row (ns): of a file from its begin, else the host's clock
  std::uint64_t missed = 0;  ///< frames that should have come between the one before and this one
};

enum class FrameStatus : std::uint8_t {
  frame,
  none,   ///< not yet
  lost,   ///< the camera is gone; it may come back
  ended,  ///< a file: there is no more
};

/// One camera. Nothing here throws; a source is opened by its constructor.
class FrameSource {
 public:
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;
  virtual ~FrameSource() = default;

  /// @param wait blocks at most so long; files never wait
  virtual FrameStatus next(std::chrono::nanoseconds wait, Frame& out) = 0;

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] double rate() const { return rate_; }  ///< nominal (1/s)
  [[nodiscard]] const std::string& name() const { return name_; }
  /// The driver's name for a live camera, and its connection; of a file empty.
  [[nodiscard]] const std::string& card() const { return card_; }
  /// Reason of the loss, or how the file ended; one line, empty where it ended as a whole one does.
  [[nodiscard]] virtual std::string reason() const { return reason_; }

 protected:
  FrameSource(std::string name, int width, int height, double rate)
      : name_(std::move(name)), width_(width), height_(height), rate_(rate) {}

  std::string name_, card_, reason_;
  int width_, height_;
  double rate_;
};

/// A film as a camera's pictures: anything that libav reads, decoded on one thread, so that it is the same every time.
/// Frames that are missing are found by the times that the file gives.
/// @throws Error (damaged) naming the file, where there is no film in it, or its frames have no times
std::unique_ptr<FrameSource> openFilmSource(const std::filesystem::path& file);

/// A camera of Video4Linux. The driver stamps frames on the host's monotonic clock and numbers them, so that latency
/// and missing frames are known. A camera that was unplugged is looked for every half second.
/// @param file /dev/videoN @param width, height that its lens was calibrated with; 0: 1280 x 720
/// @throws Error (failure) where it is not there, gives neither YUYV nor motion JPEG, or not that size
std::unique_ptr<FrameSource> openLiveCamera(const std::string& file, int width, int height);

/// /dev/videoN that capture pictures, with the driver's name of them.
std::vector<std::array<std::string, 2>> listLiveCameras();

}  // namespace calot::recorder
