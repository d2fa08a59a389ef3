// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/film_writer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cassert>
#include <string>
#include <system_error>

#include "recorder/base/errors.h"

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
constexpr int fastest = 120;       // pictures a second

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

}  // namespace

struct FilmWriter::Impl {
  std::filesystem::path file, temporary;
  int width = 0, height = 0;
  Held<AVFormatContext> format;
  Held<AVCodecContext> encoder;
  Held<AVFrame> frame;
  Held<AVPacket> packet;
  Held<SwsContext> scaler;
  AVStream* stream = nullptr;  // of the format
  std::int64_t next = 0;
  bool finished = false;

  ~Impl() {
    if (!finished) removeQuietly(temporary);
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorKind::failure, Where{file.string()}, fmt::format("cannot write the film: {}", why));
  }
  void need(int result) const {
    if (result < 0) fail(reasonOf(result));
  }

  void open(int fps) {
    AVFormatContext* made = nullptr;
    // By the name that the file will have; the temporary one has no ending.
    need(avformat_alloc_output_context2(&made, nullptr, file.extension() == ".mkv" ? "matroska" : "mp4",
                                        temporary.c_str()));
    format.reset(made);
    format->flags |= AVFMT_FLAG_BITEXACT;
    const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
    const bool h264 = codec != nullptr;
    if (!h264) codec = avcodec_find_encoder_by_name("libvpx-vp9");
    if (codec == nullptr) fail("this libav can encode neither H.264 nor VP9; install Debian's libavcodec59");
    encoder.reset(avcodec_alloc_context3(codec));
    stream = avformat_new_stream(format.get(), nullptr);
    frame.reset(av_frame_alloc());
    packet.reset(av_packet_alloc());
    if (!encoder || stream == nullptr || !frame || !packet) fail("not enough memory");
    encoder->width = width;
    encoder->height = height;
    encoder->pix_fmt = AV_PIX_FMT_YUV420P;
    encoder->time_base = {1, fps};
    encoder->framerate = {fps, 1};
    encoder->gop_size = 2 * fps;  // a player seeks to these
    encoder->thread_count = encoderThreads;
    encoder->flags |= AV_CODEC_FLAG_BITEXACT;
    encoder->color_range = AVCOL_RANGE_MPEG;
    encoder->colorspace = AVCOL_SPC_BT709;
    encoder->color_primaries = AVCOL_PRI_BT709;
    encoder->color_trc = AVCOL_TRC_BT709;
    if ((format->oformat->flags & AVFMT_GLOBALHEADER) != 0) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    // Good quality at low cost: the renderer needs the processors.
    const auto option = [&](const char* name, const char* value) {
      need(av_opt_set(encoder->priv_data, name, value, 0));
    };
    if (h264) {
      option("preset", "veryfast");
      option("crf", "21");
    } else {
      option("deadline", "realtime");
      option("cpu-used", "6");
      option("crf", "30");
    }
    need(avcodec_open2(encoder.get(), codec, nullptr));
    need(avcodec_parameters_from_context(stream->codecpar, encoder.get()));
    stream->time_base = encoder->time_base;
    stream->avg_frame_rate = encoder->framerate;

    frame->format = encoder->pix_fmt;
    frame->width = width;
    frame->height = height;
    need(av_frame_get_buffer(frame.get(), 0));
    scaler.reset(sws_getContext(width, height, AV_PIX_FMT_RGBA, width, height, AV_PIX_FMT_YUV420P,
                                SWS_BILINEAR | SWS_ACCURATE_RND | SWS_BITEXACT, nullptr, nullptr, nullptr));
    if (!scaler) fail("not enough memory");
    const int* const bt709 = sws_getCoefficients(SWS_CS_ITU709);
    need(sws_setColorspaceDetails(scaler.get(), bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16));

    need(avio_open(&format->pb, temporary.c_str(), AVIO_FLAG_WRITE));
    need(avformat_write_header(format.get(), nullptr));
  }

  /// @param input null: there is no more
  void encode(const AVFrame* input) {
    need(avcodec_send_frame(encoder.get(), input));
    while (true) {
      const int result = avcodec_receive_packet(encoder.get(), packet.get());
      if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
      need(result);
      packet->duration = 1;
      av_packet_rescale_ts(packet.get(), encoder->time_base, stream->time_base);
      packet->stream_index = stream->index;
      need(av_interleaved_write_frame(format.get(), packet.get()));
    }
  }
};

void FilmWriter::check(const std::filesystem::path& file, int width, int height, int fps) {
  if (file.extension() != ".mp4" && file.extension() != ".mkv")
    throw Error(ErrorKind::invalid, Where{file.string()}, "films are written as .mp4 or .mkv");
  if (width % 2 != 0 || height % 2 != 0)
    throw Error(ErrorKind::invalid, fmt::format("{}x{}: width and height of a film are even", width, height));
  if (fps < 1 || fps > fastest)
    throw Error(ErrorKind::invalid, fmt::format("{} frames a second: a film has 1 to {}", fps, fastest));
}

FilmWriter::FilmWriter(const std::filesystem::path& file, int width, int height, int fps)
    : impl_(std::make_unique<Impl>()) {
  check(file, width, height, fps);
  av_log_set_level(AV_LOG_QUIET);  // errors are reported by return values
  impl_->file = file;
  impl_->temporary = file;
  impl_->temporary += fmt::format(".{}.part", ::getpid());
  impl_->width = width;
  impl_->height = height;
  impl_->open(fps);
}

FilmWriter::~FilmWriter() = default;

void FilmWriter::add(const Image& image) {
  assert(image.width == impl_->width && image.height == impl_->height && !impl_->finished);
  impl_->need(av_frame_make_writable(impl_->frame.get()));
  const std::uint8_t* const rows[1] = {image.rgba.data()};
  const int stride[1] = {4 * image.width};
  sws_scale(impl_->scaler.get(), rows, stride, 0, image.height, impl_->frame->data, impl_->frame->linesize);
  impl_->frame->pts = impl_->next++;
  impl_->encode(impl_->frame.get());
}

void FilmWriter::finish() {
  impl_->encode(nullptr);
  impl_->need(av_write_trailer(impl_->format.get()));
  impl_->need(avio_closep(&impl_->format->pb));
  std::error_code error;
  std::filesystem::rename(impl_->temporary, impl_->file, error);
  if (error) impl_->fail(error.message());
  impl_->finished = true;
}

std::int64_t FilmWriter::pictures() const { return impl_->next; }

namespace {

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

void copyCleanFilm(const std::filesystem::path& film, const std::filesystem::path& output) {
  try {
    copyPictures(film, output);
  } catch (...) {
    removeQuietly(output);
    throw;
  }
}

}  // namespace calot::gui
