// SPDX-License-Identifier: GPL-3.0-or-later
// Where a camera's pictures come from.
// Compressed pictures to grey ones, by libav.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "recorder/base/files.h"

// libav's and AprilTag's
struct AVCodecContext;
struct AVCodecParameters;
struct AVFormatContext;
struct AVFrame;
struct AVPacket;
struct AVStream;
struct SwsContext;
struct apriltag_detector;
struct apriltag_family;

namespace calot::recorder {

struct FreeTags {
  void operator()(apriltag_family* p) const;
  void operator()(apriltag_detector* p) const;
};
template <class T>
using HeldTags = std::unique_ptr<T, FreeTags>;

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
/// IROS). One thread, and the same result every time.
class TagDetector {
 public:
  TagDetector();

  /// Tags with at most one corrected bit and clear contrast, in the order of their numbers. A number that is seen twice
  /// is left out: one of the two is false, and which cannot be said.
  std::vector<SeenTag> detect(const GreyImage& image);

 private:
  HeldTags<apriltag_family> family_;
  HeldTags<apriltag_detector> detector_;
};

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
  /// Reason of the loss, or how the file ended; one line, empty where it ended as a whole one does.
  [[nodiscard]] virtual std::string reason() const { return reason_; }

 protected:
  FrameSource(std::string name, int width, int height, double rate)
      : name_(std::move(name)), width_(width), height_(height), rate_(rate) {}

  std::string name_, reason_;
  int width_, height_;
  double rate_;
};

struct FreeAv {
  void operator()(AVCodecContext* p) const;
  void operator()(AVFormatContext* p) const;
  void operator()(AVFrame* p) const;
  void operator()(AVPacket* p) const;
  void operator()(SwsContext* p) const;
};
template <class T>
using HeldAv = std::unique_ptr<T, FreeAv>;

/// A decoder on one thread, and the conversion of what it gives. Luminance is passed on as the picture holds it.
class GreyDecoder {
 public:
  /// Opens a stream of a file. @returns false where libav has no decoder for it
  bool open(const AVCodecParameters& parameters);
  bool openMotionJpeg();

  [[nodiscard]] AVCodecContext* context() const { return context_.get(); }
  /// @returns false where the format is unknown to libswscale, or the picture's size differs from width and height
  bool convert(const AVFrame& frame, int width, int height, GreyImage& out);

 private:
  HeldAv<AVCodecContext> context_;
  HeldAv<SwsContext> scaler_;
  int format_ = -1;
};

/// A film as a camera's pictures: anything that libav reads, decoded on one thread, so that it is the same every time.
/// Frames that are missing are found by the times that the file gives.
class VideoFile final : public FrameSource {
 public:
  /// @throws Error (damaged) naming the file, where there is no film in it, or its frames have no times
  explicit VideoFile(const std::filesystem::path& file);

  FrameStatus next(std::chrono::nanoseconds wait, Frame& out) override;

 private:
  [[noreturn]] void fail(const std::string& why) const;
  /// @returns false at the end
  bool decode();

  HeldAv<AVFormatContext> format_;
  GreyDecoder decoder_;
  HeldAv<AVFrame> frame_;
  HeldAv<AVPacket> packet_;
  AVStream* stream_ = nullptr;      ///< of the format
  std::int64_t first_ = INT64_MIN;  ///< time of the first frame, in the stream's units: none yet
  std::int64_t last_ = -1;          ///< ns
  bool drained_ = false, ended_ = false;
};

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
  Descriptor handle_;
  bool compressed_ = false;
  std::size_t stride_ = 0;
  std::vector<Mapped> buffer_;
  GreyDecoder decoder_;
  std::int64_t lastNumber_ = -1, nextAttempt_ = 0;
};

}  // namespace calot::recorder
