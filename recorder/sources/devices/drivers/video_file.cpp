// SPDX-License-Identifier: GPL-3.0-or-later

#include <fmt/format.h>
#include <cmath>
#include <cstring>

#include "recorder/base/errors.h"
#include "recorder/sources/devices/drivers/grey_decoder.h"

extern "C" {
#include <libavutil/log.h>
#include <libavutil/pixdesc.h>
}

namespace calot::recorder {
namespace {

constexpr int mostWidth = 8192;
constexpr double lateBy = 1.5;  // periods from frame to frame; more: one is missing between them

std::string reasonOfAv(int error) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

class VideoFile final : public FrameSource {
 public:
  explicit VideoFile(const std::filesystem::path& file) : FrameSource(file.filename().string(), 0, 0, 0.0) {
    static_assert(AV_NOPTS_VALUE == INT64_MIN);
    av_log_set_level(AV_LOG_QUIET);  // errors are reported by return values
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) fail("there is no such file");
    AVDictionary* options = nullptr;
    av_dict_set(&options, "protocol_whitelist", "file", 0);  // a play list may not lead elsewhere
    AVFormatContext* opened = nullptr;
    const int result = avformat_open_input(&opened, fmt::format("file:{}", file.string()).c_str(), nullptr, &options);
    av_dict_free(&options);
    if (result < 0) fail(fmt::format("is not a film that can be read: {}", reasonOfAv(result)));
    format_.reset(opened);
    if (avformat_find_stream_info(format_.get(), nullptr) < 0) fail("is not a film that can be read");
    const int which = av_find_best_stream(format_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    if (which < 0) fail("holds no pictures");
    stream_ = format_->streams[which];
    width_ = stream_->codecpar->width;
    height_ = stream_->codecpar->height;
    if (width_ < 16 || height_ < 16 || width_ > mostWidth || height_ > mostWidth)
      fail(fmt::format("its pictures have {} x {} pixels", width_, height_));
    const AVRational guess = stream_->r_frame_rate.num > 0 ? stream_->r_frame_rate : stream_->avg_frame_rate;
    rate_ = guess.den > 0 ? av_q2d(guess) : 0.0;
    if (!(rate_ >= 1.0 && rate_ <= 1000.0)) fail("does not say how many frames a second it has");
    if (!decoder_.open(stream_->codecpar->codec_id, stream_->codecpar))
      fail("its pictures are of a kind that this libav cannot decode");
    frame_.reset(av_frame_alloc());
    packet_.reset(av_packet_alloc());
    if (!frame_ || !packet_) fail("not enough memory");
  }

  FrameStatus next(std::chrono::nanoseconds, Frame& out) override {
    while (!ended_) {
      if (!decode()) break;
      const std::int64_t stamp = frame_->best_effort_timestamp;
      if (stamp == AV_NOPTS_VALUE) {
        reason_ = name_ + ": a frame without a time was left out";
        continue;
      }
      if (first_ == AV_NOPTS_VALUE) first_ = stamp;
      const std::int64_t time = av_rescale_q(stamp - first_, stream_->time_base, AVRational{1, 1'000'000'000});
      if (time <= last_ || !decoder_.convert(*frame_, width_, height_, out.image)) {
        reason_ = name_ + ": a frame out of order or of another size was left out";
        continue;
      }
      const double periods = last_ < 0 ? 1.0 : 1e-9 * static_cast<double>(time - last_) * rate_;
      out.missed = periods > lateBy ? static_cast<std::uint64_t>(std::floor(periods - 0.5)) : 0;
      out.time = last_ = time;
      return FrameStatus::frame;
    }
    ended_ = true;
    return FrameStatus::ended;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const { throw Error(ErrorKind::damaged, Where{name_}, why); }

  /// @returns false at the end
  bool decode() {
    for (;;) {
      const int result = avcodec_receive_frame(decoder_.context(), frame_.get());
      if (result >= 0) return true;
      if (result != AVERROR(EAGAIN) || drained_) return false;
      for (;;) {
        const int read = av_read_frame(format_.get(), packet_.get());
        if (read < 0) {
          if (read != AVERROR_EOF) reason_ = fmt::format("{}: breaks off: {}", name_, reasonOfAv(read));
          drained_ = true;
          avcodec_send_packet(decoder_.context(), nullptr);
          break;
        }
        const bool ours = packet_->stream_index == stream_->index;
        const int sent = ours ? avcodec_send_packet(decoder_.context(), packet_.get()) : 0;
        av_packet_unref(packet_.get());
        if (sent < 0) reason_ = fmt::format("{}: a damaged frame was left out: {}", name_, reasonOfAv(sent));
        if (ours && sent >= 0) break;
      }
    }
  }

  HeldAv<AVFormatContext> format_;
  GreyDecoder decoder_;
  HeldAv<AVFrame> frame_;
  HeldAv<AVPacket> packet_;
  AVStream* stream_ = nullptr;      ///< of the format
  std::int64_t first_ = INT64_MIN;  ///< time of the first frame, in the stream's units: none yet
  std::int64_t last_ = -1;          ///< ns
  bool drained_ = false, ended_ = false;
};

}  // namespace

std::unique_ptr<FrameSource> openFilmSource(const std::filesystem::path& file) {
  return std::make_unique<VideoFile>(file);
}

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

}  // namespace

bool GreyDecoder::open(AVCodecID id, const AVCodecParameters* parameters) {
  const AVCodec* const codec = avcodec_find_decoder(id);
  if (codec == nullptr) return false;
  context_.reset(avcodec_alloc_context3(codec));
  if (!context_ || (parameters != nullptr && avcodec_parameters_to_context(context_.get(), parameters) < 0))
    return false;
  context_->thread_count = 1;
  context_->flags |= AV_CODEC_FLAG_BITEXACT;
  return avcodec_open2(context_.get(), codec, nullptr) >= 0;
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
