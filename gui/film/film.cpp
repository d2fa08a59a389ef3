// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/film.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "gui/film/film_writer.h"
#include "gui/film/look_ahead.h"
#include "gui/film/overlay.h"
#include "gui/render/image.h"
#include "gui/render/renderer.h"
#include "recorder/base/errors.h"
#include "recorder/kept/kept_engine.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/layout.h"
#include "recorder/replay.h"
#include "sim/scene/version.h"

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

/// Views of one recording in ascending order of time, re-simulated from the nearest keyframe or from the previous view.
class FilmSource {
 public:
  struct Scene {
    SceneView view;
    Moment moment;
    std::string doubt;  ///< why it is not what was recorded, for a mark; or empty
  };

  /// @pre the recording holds a step
  /// @throws calot::Error: damaged where the file cannot be read, or its scene cannot be built; invalid where an
  /// overlay needs what a golden recording has not; undecided where no engine of its version is here and `anyway` is
  /// not set
  FilmSource(const std::filesystem::path& recording, const FilmSettings& settings)
      : recording_(recording),
        anyway_(settings.anyway),
        foreign_(isForeign(recording_.header().simulationVersion)),
        seeker_(recording_, recorder::EngineChoice(recording_, {.anyway = anyway_ && foreign_})) {
    if (settings.overlays.needTrack() || !recorder::isMinimal(recording_.header()))
      track_ = std::make_unique<MomentTrack>(recording, settings.overlays.checkpoints);
  }

  [[nodiscard]] double seconds() const { return recording_.seconds(); }

  /// After the step that begins at a time, or the last one. @pre 0 <= time <= seconds(), and not before the last call's
  /// @throws calot::Error: damaged; refused where re-simulation comes to another State than was recorded and `anyway`
  /// is not set
  [[nodiscard]] Scene at(double time) {
    const recorder::AttemptHeader& header = recording_.header();
    const double stepSeconds = header.tickSeconds * header.ticksPerStep;
    // Times are multiples of a frame's: a rounding error must not show the step before.
    const auto begun = static_cast<std::uint64_t>(std::max(std::floor(time / stepSeconds + 1e-6), 0.0));
    const std::uint64_t step = std::min(begun, recording_.stepCount() - 1);
    seeker_.seek(step);
    Scene scene;
    scene.view = seeker_.view();
    if (foreign_) {
      scene.doubt =
          fmt::format("NOT AS RECORDED: by version {}, shown by {}", header.simulationVersion, simulationVersion);
    } else if (const auto& differs = seeker_.differsFrom()) {
      if (!anyway_)
        throw Error(ErrorKind::refused, Where{recording_.path().string()},
                    fmt::format("diverged at step {}: from there on another operation would be shown", *differs),
                    {Remedy::replayAnyway});
      scene.doubt = fmt::format("NOT AS RECORDED: differs from step {} on", *differs);
    }
    if (track_)
      scene.moment = track_->at(step);
    else
      scene.moment.time = static_cast<double>(step + 1) * stepSeconds;
    return scene;
  }

  /// "synthetic: performer skilled", "kinematics", or empty for a human operator.
  /// @param blinded "synthetic" alone, without the profile
  [[nodiscard]] std::string mark(bool blinded) const {
    const recorder::Provenance& source = recording_.header().provenance;
    if (source.kind == recorder::OperatorKind::human) return "";
    if (source.kind == recorder::OperatorKind::kinematics) return "from recorded kinematics";
    return blinded ? "synthetic" : "synthetic: performer " + source.profile;
  }
  /// Operator for a title: pseudonym or the file's name.
  [[nodiscard]] std::string title() const {
    const std::string& participant = recording_.header().participant;
    return participant.empty() ? recording_.path().stem().string() : participant;
  }

 private:
  /// No engine of the recording's version is here: this program's own shows another operation.
  static bool isForeign(std::uint32_t version) {
    return version != simulationVersion && recorder::commandOfEngine(version).empty();
  }

  recorder::Recording recording_;
  bool anyway_, foreign_;
  recorder::Seeker seeker_;
  std::unique_ptr<MomentTrack> track_;
};

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
      scenes.push_back(sources_[s]->at(own));
    }
    return scenes;
  }

  [[nodiscard]] Image draw(const Scenes& scenes) {
    const int width = settings_.size.width / static_cast<int>(scenes.size()), height = settings_.size.height;
    Image whole{settings_.size.width, height, {}};
    if (scenes.size() > 1)
      whole.rgba.resize(4 * static_cast<std::size_t>(whole.width) * static_cast<std::size_t>(height));
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      Image image =
          renderer_.render(scenes[s].view, width, height, {.quality = settings_.quality}, scenes[s].moment.smoke);
      Captions captions = captions_[std::min(s, captions_.size() - 1)];
      captions.doubt = scenes[s].doubt.empty() ? settings_.doubt : scenes[s].doubt;
      letters_.paint(image, settings_.overlays, scenes[s].moment, scenes[s].view, captions);
      if (scenes.size() == 1) return image;
      paste(image, static_cast<int>(s) * width, whole);
    }
    return whole;
  }

 private:
  void add(const std::filesystem::path& recording) {
    sources_.push_back(std::make_unique<FilmSource>(recording, settings_));
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

constexpr int fastest = 120;  // pictures a second

}  // namespace

void FilmWriter::check(const std::filesystem::path& file, int width, int height, int fps) {
  if (file.extension() != ".mp4" && file.extension() != ".mkv")
    throw Error(ErrorKind::invalid, Where{file.string()}, "films are written as .mp4 or .mkv");
  if (width % 2 != 0 || height % 2 != 0)
    throw Error(ErrorKind::invalid, fmt::format("{}x{}: width and height of a film are even", width, height));
  if (fps < 1 || fps > fastest)
    throw Error(ErrorKind::invalid, fmt::format("{} frames a second: a film has 1 to {}", fps, fastest));
}

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
  const auto writer = openFilm(output, settings.size.width, settings.size.height, settings.fps);
  LookAhead<Cutter::Scenes> scenes(
      count, [&](std::uint64_t k) { return cutter.at(settings.from + static_cast<double>(k) * each); });
  LookAhead<Image> pictures(count, [&](std::uint64_t) { return cutter.draw(scenes.next()); });
  for (std::uint64_t k = 0; k < count; ++k) {
    writer->add(pictures.next());
    if (progress) progress(k + 1, count);
  }
  writer->finish();
  return writer->pictures();
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

constexpr double behind = -1.4;  // rad; farther round, the liver is in the way

/// Number and event of the first clip's step, at which the judge scores the critical view.
std::optional<std::pair<std::uint64_t, Event>> firstClip(const std::filesystem::path& path) {
  recorder::Recording recording(path);
  recorder::RecordedJudge judge(recording.header());
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    if (!judge.observe(recording.step(n)).criticalViewFrozen) continue;
    const std::vector<Event>& events = recording.step(n).result.events;
    const auto at =
        std::find_if(events.begin(), events.end(), [](const Event& e) { return e.kind == EventKind::clipSet; });
    if (at != events.end()) return std::pair(n, *at);
  }
  return std::nullopt;
}

}  // namespace

std::optional<ShownMoment> writeDoublet(const std::filesystem::path& recording, const std::filesystem::path& output,
                                        const FilmSettings& settings) {
  checkMoment(recording, settings);
  const auto found = firstClip(recording);
  if (!found) return std::nullopt;
  const auto& [step, clip] = *found;
  Cutter cutter(recording, settings);
  const recorder::AttemptHeader header = recorder::Recording(recording).header();
  const double before = static_cast<double>(std::max<std::uint64_t>(step, 1) - 1);
  Cutter::Scenes scenes = cutter.at(before * header.tickSeconds * header.ticksPerStep);
  if (clip.hand < handCount) scenes[0].view.instrument[clip.hand] = {};
  FilmSource::Scene& back = scenes.emplace_back(scenes[0]);
  const Quat turn(Eigen::AngleAxisd(behind, -back.view.down));
  CameraSample& camera = back.view.camera;
  camera.position = clip.position + turn * (camera.position - clip.position);
  camera.orientation = turn * camera.orientation;
  writePng(cutter.draw(scenes), output);
  return ShownMoment{scenes[0].view.step - 1, scenes[0].view.time};
}

}  // namespace calot::gui
