// SPDX-License-Identifier: GPL-3.0-or-later
// Compressed pictures to grey ones, by libav.
#pragma once

#include <memory>

#include "recorder/sources/devices/camera/frame_source.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

namespace calot::recorder {

struct FreeAv {
  void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
  void operator()(AVFormatContext* p) const { avformat_close_input(&p); }
  void operator()(AVFrame* p) const { av_frame_free(&p); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(SwsContext* p) const { sws_freeContext(p); }
};
template <class T>
using HeldAv = std::unique_ptr<T, FreeAv>;

/// A decoder on one thread, and the conversion of what it gives. Luminance is passed on as the picture holds it.
class GreyDecoder {
 public:
  /// @param parameters of a stream of a file, or null
  /// @returns false where libav has no such decoder
  bool open(AVCodecID id, const AVCodecParameters* parameters);

  [[nodiscard]] AVCodecContext* context() const { return context_.get(); }
  /// @returns false where the format is unknown to libswscale, or the picture's size differs from width and height
  bool convert(const AVFrame& frame, int width, int height, GreyImage& out);

 private:
  HeldAv<AVCodecContext> context_;
  HeldAv<SwsContext> scaler_;
  int format_ = -1;
};

}  // namespace calot::recorder
