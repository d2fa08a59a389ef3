// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/film.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "gui/film/film_source.h"
#include "gui/film/film_writer.h"
#include "gui/film/look_ahead.h"
#include "gui/render/png_file.h"
#include "gui/render/renderer.h"
#include "recorder/base/errors.h"
#include "recorder/prepared_scene.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/log.h>
}

namespace calot::gui {
namespace {

/// Start of each phase, followed by the end, ascending; phases missing in either recording are omitted from both.
struct Course {
  std::vector<double> own, other;
};

Course alignedCourse(const std::filesystem::path& own, double ownEnd, const std::filesystem::path& other,
                     double otherEnd) {
  Course course{{0.0}, {0.0}};
  const std::array<double, 4> a = phaseStarts(own), b = phaseStarts(other);
  for (std::size_t p = 0; p < a.size(); ++p)
    if (a[p] > course.own.back() && b[p] > course.other.back()) {
      course.own.push_back(a[p]);
      course.other.push_back(b[p]);
    }
  course.own.push_back(std::max(ownEnd, course.own.back()));
  course.other.push_back(std::max(otherEnd, course.other.back()));
  return course;
}

/// Time of the second recording that corresponds to a time of the first.
double timeBeside(const Course& course, double time) {
  const auto after = std::upper_bound(course.own.begin() + 1, course.own.end() - 1, time);
  const auto i = static_cast<std::size_t>(after - course.own.begin());
  const double length = course.own[i] - course.own[i - 1];
  const double share = length > 0.0 ? std::clamp((time - course.own[i - 1]) / length, 0.0, 1.0) : 1.0;
  return course.other[i - 1] + share * (course.other[i] - course.other[i - 1]);
}

void paste(const Image& from, int x, Image& to) {
  for (int y = 0; y < from.height; ++y)
    std::copy_n(from.pixel(0, y), 4 * static_cast<std::size_t>(from.width),
                to.rgba.begin() + 4 * (static_cast<std::ptrdiff_t>(y) * to.width + x));
}

/// One or two recordings, frame by frame. One thread may call at() while another calls draw().
class Cutter {
 public:
  using Scenes = std::vector<FilmSource::Scene>;

  Cutter(const std::filesystem::path& recording, const FilmSettings& settings) : settings_(settings) {
    add(recording);
    if (settings.beside) add(*settings.beside);
    if (settings.beside && settings.alignment == Alignment::phase)
      course_ = alignedCourse(recording, sources_[0]->seconds(), *settings.beside, sources_[1]->seconds());
  }

  [[nodiscard]] double seconds() const { return sources_[0]->seconds(); }

  [[nodiscard]] Scenes at(double time) {
    Scenes scenes;
    for (std::size_t s = 0; s < sources_.size(); ++s) {
      const double own = s == 0 || course_.own.empty() ? time : timeBeside(course_, time);
      scenes.push_back(sources_[s]->at(sources_[s]->stepAt(own)));
    }
    return scenes;
  }

  [[nodiscard]] Image draw(const Scenes& scenes) {
    const int width = settings_.size.width / static_cast<int>(scenes.size()), height = settings_.size.height;
    RenderSettings quality;
    quality.quality = settings_.quality;
    Image whole;
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      Image image = renderer_.render(scenes[s].view, width, height, quality, scenes[s].moment.smoke);
      Captions captions = captions_[s];
      captions.doubt = scenes[s].doubt.empty() ? settings_.doubt : scenes[s].doubt;
      letters_.paint(image, settings_.overlays, scenes[s].moment, scenes[s].view, captions);
      if (scenes.size() == 1) return image;
      if (s == 0) {
        whole.width = settings_.size.width;
        whole.height = height;
        whole.rgba.resize(4 * static_cast<std::size_t>(whole.width) * static_cast<std::size_t>(height));
      }
      paste(image, static_cast<int>(s) * width, whole);
    }
    return whole;
  }

 private:
  void add(const std::filesystem::path& recording) {
    sources_.push_back(std::make_unique<FilmSource>(recording, settings_.overlays, settings_.anyway));
    const FilmSource& source = *sources_.back();
    captions_.push_back({settings_.beside ? source.title() : "", source.mark(settings_.blinded), ""});
  }

  FilmSettings settings_;
  std::vector<std::unique_ptr<FilmSource>> sources_;  ///< of at()'s thread
  std::vector<Captions> captions_;                    ///< for draw()'s thread
  Course course_;                                     ///< empty: both from their starts
  Renderer renderer_{settings_.graphics};
  OverlayPainter letters_{settings_.size.height};
};

/// Length of a recording that has something to draw, and an engine that draws it (s).
double secondsOf(const std::filesystem::path& recording, bool anyway) {
  const recorder::Recording opened(recording);
  if (opened.stepCount() == 0) throw Error(ErrorKind::damaged, Where{recording.string()}, "holds no step to draw");
  if (!anyway) static_cast<void>(recorder::EngineChoice(opened, {}));
  return opened.seconds();
}

void checkTime(const std::filesystem::path& recording, double time, double seconds) {
  if (time > seconds)
    throw Error(ErrorKind::invalid, Where{recording.string()},
                fmt::format("is {:.2f} s long, there is nothing at {:.2f} s", seconds, time));
}

void checkBeside(const FilmSettings& settings) {
  if (!settings.beside) return;
  static_cast<void>(secondsOf(*settings.beside, settings.anyway));
  if (settings.size.width % 4 != 0)
    throw Error(ErrorKind::invalid,
                fmt::format("{} pixels wide: two recordings side by side need a multiple of 4", settings.size.width));
}

}  // namespace

void checkFilm(const std::filesystem::path& recording, const std::filesystem::path& output,
               const FilmSettings& settings) {
  FilmWriter::check(output, settings.size.width, settings.size.height, settings.fps);
  if (!(settings.speed >= 0.01 && settings.speed <= 100.0))
    throw Error(ErrorKind::invalid, fmt::format("{} times as fast: a film goes 0.01 to 100 times", settings.speed));
  checkBeside(settings);
  const double seconds = secondsOf(recording, settings.anyway);
  const double to = settings.to.value_or(seconds);
  checkTime(recording, to, seconds);
  if (settings.from >= to)
    throw Error(ErrorKind::invalid, Where{recording.string()},
                fmt::format("from {:.2f} s to {:.2f} s there is nothing", settings.from, to));
}

void checkMoment(const std::filesystem::path& recording, const FilmSettings& settings) {
  checkBeside(settings);
  checkTime(recording, settings.from, secondsOf(recording, settings.anyway));
}

std::int64_t writeFilm(const std::filesystem::path& recording, const std::filesystem::path& output,
                       const FilmSettings& settings,
                       const std::function<void(std::uint64_t done, std::uint64_t of)>& progress) {
  checkFilm(recording, output, settings);
  Cutter cutter(recording, settings);
  const double to = settings.to.value_or(cutter.seconds());
  const double each = settings.speed / settings.fps;
  const auto count = static_cast<std::uint64_t>(std::max(1.0, std::ceil((to - settings.from) / each - 1e-6)));
  FilmWriter writer(output, settings.size.width, settings.size.height, settings.fps);
  LookAhead<Cutter::Scenes> scenes(
      count, [&](std::uint64_t k) { return cutter.at(settings.from + static_cast<double>(k) * each); });
  LookAhead<Image> pictures(count, [&](std::uint64_t) { return cutter.draw(scenes.next()); });
  for (std::uint64_t k = 0; k < count; ++k) {
    writer.add(pictures.next());
    if (progress) progress(k + 1, count);
  }
  writer.finish();
  return writer.pictures();
}

ShownMoment writeMoment(const std::filesystem::path& recording, const std::filesystem::path& output,
                        const FilmSettings& settings) {
  checkMoment(recording, settings);
  Cutter cutter(recording, settings);
  const Cutter::Scenes scenes = cutter.at(settings.from);
  writePng(cutter.draw(scenes), output);
  return {scenes[0].view.step - 1, scenes[0].view.time};
}

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
