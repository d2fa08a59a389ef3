// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/film_writer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cassert>
#include <memory>
#include <string>
#include <system_error>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/imgutils.h>
#include <libavutil/log.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

namespace calot::gui {
namespace {

constexpr int encoderThreads = 1;  // the renderer needs the processors

std::string reasonOf(int error) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

struct Free {
  void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
  void operator()(AVFrame* p) const { av_frame_free(&p); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(SwsContext* p) const { sws_freeContext(p); }
  void operator()(AVFormatContext* p) const {
    if (p->pb != nullptr) avio_closep(&p->pb);
    avformat_free_context(p);
  }
};
template <class T>
using Held = std::unique_ptr<T, Free>;
struct CloseInput {
  void operator()(AVFormatContext* p) const { avformat_close_input(&p); }
};

void removeQuietly(const std::filesystem::path& file) {
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
}

class Encoder final : public FilmWriter {
 public:
  Encoder(const std::filesystem::path& file, int width, int height)
      : file_(file), made_(file, true, fmt::format(".{}.part", ::getpid())), width_(width), height_(height) {}

  void open(int fps) {
    AVFormatContext* made = nullptr;
    // By the name that the file will have; the temporary one has no ending.
    need(avformat_alloc_output_context2(&made, nullptr, file_.extension() == ".mkv" ? "matroska" : "mp4",
                                        made_.path().c_str()));
    format_.reset(made);
    format_->flags |= AVFMT_FLAG_BITEXACT;
    const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
    const bool h264 = codec != nullptr;
    if (!h264) codec = avcodec_find_encoder_by_name("libvpx-vp9");
    if (codec == nullptr) fail("this libav can encode neither H.264 nor VP9; install Debian's libavcodec59");
    encoder_.reset(avcodec_alloc_context3(codec));
    stream_ = avformat_new_stream(format_.get(), nullptr);
    frame_.reset(av_frame_alloc());
    packet_.reset(av_packet_alloc());
    if (!encoder_ || stream_ == nullptr || !frame_ || !packet_) fail("not enough memory");
    encoder_->width = width_;
    encoder_->height = height_;
    encoder_->pix_fmt = AV_PIX_FMT_YUV420P;
    encoder_->time_base = {1, fps};
    encoder_->framerate = {fps, 1};
    encoder_->gop_size = 2 * fps;  // a player seeks to these
    encoder_->thread_count = encoderThreads;
    encoder_->flags |= AV_CODEC_FLAG_BITEXACT;
    encoder_->color_range = AVCOL_RANGE_MPEG;
    encoder_->colorspace = AVCOL_SPC_BT709;
    encoder_->color_primaries = AVCOL_PRI_BT709;
    encoder_->color_trc = AVCOL_TRC_BT709;
    if ((format_->oformat->flags & AVFMT_GLOBALHEADER) != 0) encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    // Good quality at low cost: the renderer needs the processors.
    const auto option = [&](const char* name, const char* value) {
      need(av_opt_set(encoder_->priv_data, name, value, 0));
    };
    if (h264) {
      option("preset", "veryfast");
      option("crf", "21");
    } else {
      option("deadline", "realtime");
      option("cpu-used", "6");
      option("crf", "30");
    }
    need(avcodec_open2(encoder_.get(), codec, nullptr));
    need(avcodec_parameters_from_context(stream_->codecpar, encoder_.get()));
    stream_->time_base = encoder_->time_base;
    stream_->avg_frame_rate = encoder_->framerate;

    frame_->format = encoder_->pix_fmt;
    frame_->width = width_;
    frame_->height = height_;
    need(av_frame_get_buffer(frame_.get(), 0));
    scaler_.reset(sws_getContext(width_, height_, AV_PIX_FMT_RGBA, width_, height_, AV_PIX_FMT_YUV420P,
                                 SWS_BILINEAR | SWS_ACCURATE_RND | SWS_BITEXACT, nullptr, nullptr, nullptr));
    if (!scaler_) fail("not enough memory");
    const int* const bt709 = sws_getCoefficients(SWS_CS_ITU709);
    need(sws_setColorspaceDetails(scaler_.get(), bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16));

    need(avio_open(&format_->pb, made_.path().c_str(), AVIO_FLAG_WRITE));
    need(avformat_write_header(format_.get(), nullptr));
  }

  void add(const Image& image) override {
    assert(image.width == width_ && image.height == height_);
    need(av_frame_make_writable(frame_.get()));
    const std::uint8_t* const rows[1] = {image.rgba.data()};
    const int stride[1] = {4 * image.width};
    sws_scale(scaler_.get(), rows, stride, 0, image.height, frame_->data, frame_->linesize);
    frame_->pts = next_++;
    encode(frame_.get());
  }

  void finish() override {
    encode(nullptr);
    need(av_write_trailer(format_.get()));
    need(avio_closep(&format_->pb));
    made_.publish();
  }

  [[nodiscard]] std::int64_t pictures() const override { return next_; }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorKind::failure, Where{file_.string()}, fmt::format("cannot write the film: {}", why));
  }
  void need(int result) const {
    if (result < 0) fail(reasonOf(result));
  }

  /// @param input null: there is no more
  void encode(const AVFrame* input) {
    need(avcodec_send_frame(encoder_.get(), input));
    while (true) {
      const int result = avcodec_receive_packet(encoder_.get(), packet_.get());
      if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
      need(result);
      packet_->duration = 1;
      av_packet_rescale_ts(packet_.get(), encoder_->time_base, stream_->time_base);
      packet_->stream_index = stream_->index;
      need(av_interleaved_write_frame(format_.get(), packet_.get()));
    }
  }

  std::filesystem::path file_;
  recorder::NewFile made_;
  int width_, height_;
  Held<AVFormatContext> format_;
  Held<AVCodecContext> encoder_;
  Held<AVFrame> frame_;
  Held<AVPacket> packet_;
  Held<SwsContext> scaler_;
  AVStream* stream_ = nullptr;  // of the format
  std::int64_t next_ = 0;
};

void needFilm(int result, const std::filesystem::path& film) {
  if (result < 0)
    throw Error(ErrorKind::damaged, Where{film.string()},
                fmt::format("cannot be read as a film: {}", reasonOf(result)));
}

void needCopy(int result, const std::filesystem::path& output) {
  if (result < 0)
    throw Error(ErrorKind::failure, Where{output.string()},
                fmt::format("the film cannot be written: {}", reasonOf(result)));
}

void copyPictures(const std::filesystem::path& film, const std::filesystem::path& output) {
  av_log_set_level(AV_LOG_QUIET);  // errors are reported by return values
  AVFormatContext* opened = nullptr;
  needFilm(avformat_open_input(&opened, film.c_str(), nullptr, nullptr), film);
  const std::unique_ptr<AVFormatContext, CloseInput> input(opened);
  needFilm(avformat_find_stream_info(input.get(), nullptr), film);
  const int pictures = av_find_best_stream(input.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  needFilm(pictures, film);
  const AVStream* const from = input->streams[pictures];

  AVFormatContext* made = nullptr;
  needCopy(avformat_alloc_output_context2(&made, nullptr, "mp4", output.c_str()), output);
  const Held<AVFormatContext> copy(made);
  copy->flags |= AVFMT_FLAG_BITEXACT;  // neither date nor program
  AVStream* const to = avformat_new_stream(copy.get(), nullptr);
  if (to == nullptr) throw Error(ErrorKind::failure, Where{output.string()}, "not enough memory");
  needCopy(avcodec_parameters_copy(to->codecpar, from->codecpar), output);
  to->codecpar->codec_tag = 0;  // MP4's own, whatever the other container had
  to->time_base = from->time_base;
  to->avg_frame_rate = from->avg_frame_rate;
  if (avformat_query_codec(copy->oformat, to->codecpar->codec_id, FF_COMPLIANCE_NORMAL) != 1) {
    throw Error(ErrorKind::damaged, Where{film.string()},
                "its pictures cannot be in MP4, which browsers play; encode them as H.264");
  }
  needCopy(avio_open(&copy->pb, output.c_str(), AVIO_FLAG_WRITE), output);
  needCopy(avformat_write_header(copy.get(), nullptr), output);
  const Held<AVPacket> packet(av_packet_alloc());
  if (!packet) throw Error(ErrorKind::failure, Where{output.string()}, "not enough memory");
  while (true) {
    const int result = av_read_frame(input.get(), packet.get());
    if (result == AVERROR_EOF) break;
    needFilm(result, film);
    if (packet->stream_index == pictures) {
      packet->stream_index = to->index;
      av_packet_rescale_ts(packet.get(), from->time_base, to->time_base);
      packet->pos = -1;
      needCopy(av_interleaved_write_frame(copy.get(), packet.get()), output);
    }
    av_packet_unref(packet.get());
  }
  needCopy(av_write_trailer(copy.get()), output);
  needCopy(avio_closep(&copy->pb), output);
}

}  // namespace

std::unique_ptr<FilmWriter> openFilm(const std::filesystem::path& file, int width, int height, int fps) {
  av_log_set_level(AV_LOG_QUIET);  // errors are reported by return values
  auto encoder = std::make_unique<Encoder>(file, width, height);
  encoder->open(fps);
  return encoder;
}

void copyCleanFilm(const std::filesystem::path& film, const std::filesystem::path& output) {
  try {
    copyPictures(film, output);
  } catch (...) {
    removeQuietly(output);
    throw;
  }
}

}  // namespace calot::gui
