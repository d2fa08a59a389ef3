// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/grey_decoder.h"

#include <cstring>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/frame.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

namespace calot::recorder {
namespace {

/// Is the first plane luminance, a byte a pixel?
bool firstPlaneIsGrey(int format) {
  const AVPixFmtDescriptor* const about = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(format));
  if (about == nullptr) return false;
  constexpr std::uint64_t other = AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM |
                                  AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_BAYER;
  const AVComponentDescriptor& luminance = about->comp[0];
  return (about->flags & other) == 0 && luminance.plane == 0 && luminance.step == 1 && luminance.offset == 0 &&
         luminance.depth == 8;
}

bool start(AVCodecContext* context, const AVCodec* codec) {
  context->thread_count = 1;
  context->flags |= AV_CODEC_FLAG_BITEXACT;
  return avcodec_open2(context, codec, nullptr) >= 0;
}

}  // namespace

void FreeAv::operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
void FreeAv::operator()(AVFrame* p) const { av_frame_free(&p); }
void FreeAv::operator()(AVPacket* p) const { av_packet_free(&p); }
void FreeAv::operator()(SwsContext* p) const { sws_freeContext(p); }

bool GreyDecoder::open(const AVCodecParameters& parameters) {
  const AVCodec* const codec = avcodec_find_decoder(parameters.codec_id);
  if (codec == nullptr) return false;
  context_.reset(avcodec_alloc_context3(codec));
  return context_ && avcodec_parameters_to_context(context_.get(), &parameters) >= 0 && start(context_.get(), codec);
}

bool GreyDecoder::openMotionJpeg() {
  const AVCodec* const codec = avcodec_find_decoder(AV_CODEC_ID_MJPEG);
  if (codec == nullptr) return false;
  context_.reset(avcodec_alloc_context3(codec));
  return context_ && start(context_.get(), codec);
}

bool GreyDecoder::convert(const AVFrame& frame, int width, int height, GreyImage& out) {
  if (frame.width != width || frame.height != height) return false;
  out.width = width;
  out.height = height;
  out.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  if (firstPlaneIsGrey(frame.format)) {
    for (int y = 0; y < height; ++y) {
      std::memcpy(out.pixels.data() + static_cast<std::ptrdiff_t>(y) * width,
                  frame.data[0] + static_cast<std::ptrdiff_t>(y) * frame.linesize[0], static_cast<std::size_t>(width));
    }
    return true;
  }
  if (frame.format != format_) {
    scaler_.reset(sws_getContext(width, height, static_cast<AVPixelFormat>(frame.format), width, height,
                                 AV_PIX_FMT_GRAY8, SWS_BILINEAR | SWS_ACCURATE_RND | SWS_BITEXACT, nullptr, nullptr,
                                 nullptr));
    format_ = frame.format;
  }
  if (!scaler_) return false;
  std::uint8_t* const rows[1] = {out.pixels.data()};
  const int stride[1] = {width};
  return sws_scale(scaler_.get(), frame.data, frame.linesize, 0, height, rows, stride) == height;
}

}  // namespace calot::recorder
