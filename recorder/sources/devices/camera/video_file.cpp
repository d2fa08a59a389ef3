// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/sources/devices/camera/frame_source.h"

#include <fmt/format.h>
#include <cmath>
#include <cstring>

#include "recorder/base/errors.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/log.h>
}

namespace calot::recorder {
namespace {

constexpr int mostWidth = 8192;
constexpr double lateBy = 1.5;  // periods from frame to frame; more: one is missing between them

struct CloseInput {
  void operator()(AVFormatContext* p) const { avformat_close_input(&p); }
};

std::string reasonOfAv(int error) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

}  // namespace

struct VideoFile::Impl {
  VideoFile& film;
  std::unique_ptr<AVFormatContext, CloseInput> format;
  GreyDecoder decoder;
  HeldAv<AVFrame> frame;
  HeldAv<AVPacket> packet;
  AVStream* stream = nullptr;           // of the format
  std::int64_t first = AV_NOPTS_VALUE;  // in the stream's units
  std::int64_t last = -1;               // ns
  bool drained = false, ended = false;

  explicit Impl(VideoFile& of) : film(of) {}

  [[noreturn]] void fail(const std::string& why) const { throw Error(ErrorKind::damaged, Where{film.name_}, why); }

  void open(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) fail("there is no such file");
    AVDictionary* options = nullptr;
    av_dict_set(&options, "protocol_whitelist", "file", 0);  // a play list may not lead elsewhere
    AVFormatContext* opened = nullptr;
    const int result = avformat_open_input(&opened, fmt::format("file:{}", file.string()).c_str(), nullptr, &options);
    av_dict_free(&options);
    if (result < 0) fail(fmt::format("is no film that can be read: {}", reasonOfAv(result)));
    format.reset(opened);
    if (avformat_find_stream_info(format.get(), nullptr) < 0) fail("is no film that can be read");
    const int which = av_find_best_stream(format.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    if (which < 0) fail("holds no pictures");
    stream = format->streams[which];
    film.width_ = stream->codecpar->width;
    film.height_ = stream->codecpar->height;
    if (film.width_ < 16 || film.height_ < 16 || film.width_ > mostWidth || film.height_ > mostWidth)
      fail(fmt::format("its pictures have {} x {} pixels", film.width_, film.height_));
    const AVRational guess = stream->r_frame_rate.num > 0 ? stream->r_frame_rate : stream->avg_frame_rate;
    film.rate_ = guess.den > 0 ? av_q2d(guess) : 0.0;
    if (!(film.rate_ >= 1.0 && film.rate_ <= 1000.0)) fail("does not say how many frames a second it has");
    if (!decoder.open(*stream->codecpar)) fail("its pictures are of a kind that this libav cannot decode");
    frame.reset(av_frame_alloc());
    packet.reset(av_packet_alloc());
    if (!frame || !packet) fail("not enough memory");
  }

  /// @returns false at the end
  bool decode() {
    for (;;) {
      const int result = avcodec_receive_frame(decoder.context(), frame.get());
      if (result >= 0) return true;
      if (result != AVERROR(EAGAIN) || drained) return false;
      for (;;) {
        const int read = av_read_frame(format.get(), packet.get());
        if (read < 0) {
          if (read != AVERROR_EOF) film.reason_ = fmt::format("{}: breaks off: {}", film.name_, reasonOfAv(read));
          drained = true;
          avcodec_send_packet(decoder.context(), nullptr);
          break;
        }
        const bool ours = packet->stream_index == stream->index;
        const int sent = ours ? avcodec_send_packet(decoder.context(), packet.get()) : 0;
        av_packet_unref(packet.get());
        if (sent < 0) film.reason_ = fmt::format("{}: a damaged frame was left out: {}", film.name_, reasonOfAv(sent));
        if (ours && sent >= 0) break;
      }
    }
  }
};

VideoFile::VideoFile(const std::filesystem::path& file)
    : FrameSource(file.filename().string(), 0, 0, 0.0), impl_(std::make_unique<Impl>(*this)) {
  av_log_set_level(AV_LOG_QUIET);  // errors are reported by return values
  impl_->open(file);
}

VideoFile::~VideoFile() = default;

FrameStatus VideoFile::next(std::chrono::nanoseconds, Frame& out) {
  Impl& i = *impl_;
  while (!i.ended) {
    if (!i.decode()) break;
    const std::int64_t stamp = i.frame->best_effort_timestamp;
    if (stamp == AV_NOPTS_VALUE) {
      reason_ = name_ + ": a frame without a time was left out";
      continue;
    }
    if (i.first == AV_NOPTS_VALUE) i.first = stamp;
    const std::int64_t time = av_rescale_q(stamp - i.first, i.stream->time_base, AVRational{1, 1'000'000'000});
    if (time <= i.last || !i.decoder.convert(*i.frame, width_, height_, out.image)) {
      reason_ = name_ + ": a frame out of order or of another size was left out";
      continue;
    }
    const double periods = i.last < 0 ? 1.0 : 1e-9 * static_cast<double>(time - i.last) * rate_;
    out.missed = periods > lateBy ? static_cast<std::uint64_t>(std::floor(periods - 0.5)) : 0;
    out.time = i.last = time;
    return FrameStatus::frame;
  }
  i.ended = true;
  return FrameStatus::ended;
}

}  // namespace calot::recorder

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
