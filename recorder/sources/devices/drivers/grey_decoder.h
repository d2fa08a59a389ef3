// SPDX-License-Identifier: GPL-3.0-or-later
// Compressed pictures to grey ones, by libav.
#pragma once

#include <memory>

#include "recorder/sources/devices/camera/frame_source.h"

struct AVCodecContext;
struct AVCodecParameters;
struct AVFormatContext;
struct AVFrame;
struct AVPacket;
struct SwsContext;

namespace calot::recorder {

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

}  // namespace calot::recorder
