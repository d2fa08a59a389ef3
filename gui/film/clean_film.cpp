// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/clean_film.h"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <string>
#include <system_error>

#include "recorder/base/errors.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/log.h>
}

namespace calot::gui {
namespace {

struct CloseFilm {
  void operator()(AVFormatContext* p) const { avformat_close_input(&p); }
};
struct FreeCopy {
  void operator()(AVFormatContext* p) const {
    if (p->pb != nullptr) avio_closep(&p->pb);
    avformat_free_context(p);
  }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
};

std::string wordsOf(int error) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

void needFilm(int result, const std::filesystem::path& film) {
  if (result < 0) {
    throw Error(ErrorKind::damaged, Where{film.string()}, fmt::format("cannot be read as a film: {}", wordsOf(result)));
  }
}

void needCopy(int result, const std::filesystem::path& output) {
  if (result < 0)
    throw Error(ErrorKind::failure, Where{output.string()},
                fmt::format("the film cannot be written: {}", wordsOf(result)));
}

void copyPictures(const std::filesystem::path& film, const std::filesystem::path& output) {
  av_log_set_level(AV_LOG_QUIET);  // errors are reported by return values
  AVFormatContext* opened = nullptr;
  needFilm(avformat_open_input(&opened, film.c_str(), nullptr, nullptr), film);
  const std::unique_ptr<AVFormatContext, CloseFilm> input(opened);
  needFilm(avformat_find_stream_info(input.get(), nullptr), film);
  const int pictures = av_find_best_stream(input.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  needFilm(pictures, film);
  const AVStream* const from = input->streams[pictures];

  AVFormatContext* made = nullptr;
  needCopy(avformat_alloc_output_context2(&made, nullptr, "mp4", output.c_str()), output);
  const std::unique_ptr<AVFormatContext, FreeCopy> copy(made);
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
  const std::unique_ptr<AVPacket, FreeCopy> packet(av_packet_alloc());
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
    std::error_code ignored;
    std::filesystem::remove(output, ignored);
    throw;
  }
}

}  // namespace calot::gui
