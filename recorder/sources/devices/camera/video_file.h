// SPDX-License-Identifier: GPL-3.0-or-later
// Compressed pictures to grey ones, by libav.
#pragma once

#include <filesystem>
#include <memory>

#include "recorder/sources/devices/camera/frame_source.h"

namespace calot::recorder {

/// A film as a camera's pictures: anything that libav reads, decoded on one thread, so that it is the same every time.
/// Frames that are missing are found by the times that the file gives.
class VideoFile final : public FrameSource {
 public:
  /// @throws Error (damaged) naming the file, where there is no film in it, or its frames have no times
  explicit VideoFile(const std::filesystem::path& file);
  ~VideoFile() override;

  FrameStatus next(std::chrono::nanoseconds wait, Frame& out) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace calot::recorder

struct AVCodecContext;
struct AVCodecParameters;
struct AVFrame;
struct AVPacket;
struct SwsContext;

namespace calot::recorder {

struct FreeAv {
  void operator()(AVCodecContext* p) const;
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
  /// Opens motion JPEG, which cameras send.
  bool openMotionJpeg();

  [[nodiscard]] AVCodecContext* context() const { return context_.get(); }
  /// @returns false where the format is unknown to libswscale, or the picture's size differs from width and height
  bool convert(const AVFrame& frame, int width, int height, GreyImage& out);

 private:
  HeldAv<AVCodecContext> context_;
  HeldAv<SwsContext> scaler_;
  int format_ = -1;
};

}  // namespace calot::recorder
