// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/camera_calibration.h"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "recorder/base/errors.h"
#include "recorder/sources/devices/camera/frame_source.h"
#include "recorder/sources/devices/camera/lens_calibration.h"
#include "recorder/sources/devices/camera/marker_sheets.h"
#include "recorder/sources/devices/dense_solvers.h"

namespace calot::recorder {
namespace {

constexpr std::size_t fewestShafts = 10;
constexpr double fewestSpread = 0.005;  // smallest eigenvalue of the mean projection across the shafts: about 4 degrees
constexpr double longestPhase = 36000.0;
constexpr std::array<std::pair<const char*, double>, 6> guidedSteps{{{"rest", 5.0},
                                                                     {"pivot", 20.0},
                                                                     {"stroke right", 6.0},
                                                                     {"stroke down", 6.0},
                                                                     {"stroke away", 6.0},
                                                                     {"trocar", 15.0}}};
constexpr double boardSeconds = 30.0;

/// Frames of a live camera for some time, as if they were a film.
class LimitedSource final : public FrameSource {
 public:
  LimitedSource(FrameSource& source, double seconds)
      : FrameSource(source.name(), source.width(), source.height(), source.rate()),
        source_(&source),
        end_(monotonicNanoseconds() + static_cast<std::int64_t>(1e9 * seconds)) {}
  FrameStatus next(std::chrono::nanoseconds, Frame& out) override {
    while (monotonicNanoseconds() < end_) {
      const FrameStatus status = source_->next(std::chrono::milliseconds(20), out);
      if (status == FrameStatus::frame || status == FrameStatus::ended) return status;
    }
    return FrameStatus::ended;
  }

 private:
  FrameSource* source_;
  std::int64_t end_;
};

void addLens(FrameSource& source, const RigSettings& settings, RigFit& fit) {
  fit.lens.push_back(fitLens(boardViews(source), source.width(), source.height(), settings.printScale, source.name()));
  fit.lens.back().lens.readout = settings.readout;
  RigCamera camera;
  camera.lens = fit.lens.back().lens;
  fit.rig.cameras.push_back(camera);
}

void addPair(FrameSource& first, FrameSource& second, const RigSettings& settings, RigFit& fit) {
  std::vector<BoardView> a, b;
  pairedViews(first, second, a, b);
  const PairFit pair =
      fitPair(a, fit.lens[0], b, fit.lens[1], settings.printScale, first.name() + ", " + second.name());
  fit.rig.cameras[1].fromDevice = pair.second;
  fit.rig.cameras[1].pairResidual = pair.residual;
}

/// Seconds at the begin of `text`, which is cut off. @returns whether there were any
bool takeSeconds(std::string_view& text, double& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (error != std::errc() || !(out >= 0.0 && out <= longestPhase)) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

std::int64_t nanosecondsOf(double seconds) { return static_cast<std::int64_t>(std::floor(1e9 * seconds + 0.5)); }

}  // namespace

RigFit measureRigFromFilms(const std::vector<std::string>& films, const RigSettings& settings) {
  if (films.empty() || films.size() > 2) throw Error(ErrorKind::invalid, "the board is filmed by one or two cameras");
  RigFit fit;
  fit.identity = "camera:film";
  fit.rig.printScale = settings.printScale;
  for (const std::unique_ptr<FrameSource>& source : openFilmSources(films)) addLens(*source, settings, fit);
  if (films.size() == 2) {
    const std::vector<std::unique_ptr<FrameSource>> again = openFilmSources(films);
    addPair(*again[0], *again[1], settings, fit);
  }
  return fit;
}

RigFit measureRigLive(const CameraRequest& request, const RigSettings& settings,
                      const std::function<void(const std::string& text)>& step) {
  RigFit fit;
  fit.rig.printScale = settings.printScale;
  std::vector<std::unique_ptr<FrameSource>> cameras;
  std::vector<std::string> cards;
  for (const std::string& file : request.cameras) {
    cameras.push_back(openLiveCamera(file, 0, 0));
    cards.push_back(cameras.back()->card());
  }
  fit.identity = cameraIdentity(cards);
  for (const std::unique_ptr<FrameSource>& camera : cameras) {
    step(fmt::format(
        "Show the board to {}: hold it still for a moment, tilt it by 30 degrees, move it to each corner of "
        "the picture, and so on ({:g} s).",
        camera->name(), boardSeconds));
    LimitedSource source(*camera, boardSeconds);
    addLens(source, settings, fit);
  }
  if (cameras.size() == 2) {
    step(fmt::format("Show the board to both cameras at once, holding it still in ten places ({:g} s).", boardSeconds));
    LimitedSource first(*cameras[0], boardSeconds), second(*cameras[1], boardSeconds);
    addPair(first, second, settings, fit);
  }
  return fit;
}

DeviceScript streamOf(Device& device, TickClock& clock) {
  DeviceScript out;
  out.name = device.info().identity;
  out.file = device.info().sourceFile;
  out.rate = device.info().capabilities.rate;
  const std::int64_t begin = clock.now;
  DeviceInput input;
  while (!device.ended()) {
    input.samples.clear();
    device.poll(std::chrono::nanoseconds(0), input);
    for (DeviceSample sample : input.samples) {
      sample.hostTime -= begin;
      out.samples.push_back(sample);
    }
    clock.now += 1'000'000'000;
  }
  return out;
}

std::optional<Trocar> fitTrocar(std::span<const DeviceSample> samples) {
  if (samples.size() < fewestShafts) return std::nullopt;
  const auto n = static_cast<double>(samples.size());
  Mat3 normal = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  for (const DeviceSample& s : samples) {
    const Vec3 shaft = s.orientation * Vec3::UnitZ();
    const Mat3 across = Mat3::Identity() - shaft * shaft.transpose();
    normal += across / n;
    right += across * s.position / n;
  }
  if (!(eigenOf(normal).values[0] >= fewestSpread)) return std::nullopt;
  Trocar out;
  out.point = solved(normal, right);
  double squares = 0.0;
  for (const DeviceSample& s : samples) {
    const Vec3 shaft = s.orientation * Vec3::UnitZ();
    squares += shaft.cross(out.point - s.position).squaredNorm();
  }
  out.residual = std::sqrt(squares / n);
  return out;
}

void measureTrocars(const DeviceScript& stream, Calibration& calibration) {
  for (const Hand hand : {Hand::left, Hand::right}) {
    const auto h = static_cast<std::size_t>(hand);
    const std::vector<DeviceSample> shafts = samplesIn(stream, hand, "trocar");
    if (shafts.empty()) continue;
    const std::optional<Trocar> trocar = fitTrocar(shafts);
    if (!trocar) {
      throw Error(
          ErrorKind::damaged, Where{stream.file},
          fmt::format("{} hand: the phase \"trocar\" ({} samples) does not tilt the shaft enough: sweep it by 20 "
                      "degrees in all directions",
                      handNames[h], shafts.size()));
    }
    calibration.camera->trocar[h] = trocar;
  }
}

void measureLatency(const DeviceScript& stream, bool live, Calibration& calibration) {
  if (!live) {
    calibration.latency = "not measured: a film does not tell it";
    return;
  }
  std::vector<std::int64_t> delay;
  for (const DeviceSample& s : stream.samples) {
    if (s.deviceTime >= 0) delay.push_back(s.hostTime - s.deviceTime);
  }
  if (delay.empty()) return;
  std::sort(delay.begin(), delay.end());
  const double unit = 1e-6;
  calibration.latency = fmt::format("{:.1f} ms from exposure to pose, {:.1f} ms at 99 %",
                                    unit * static_cast<double>(delay[delay.size() / 2]),
                                    unit * static_cast<double>(delay[delay.size() * 99 / 100]));
}

std::vector<DeviceScript::Phase> parsePhases(const std::string& text) {
  const auto refuse = [&](const std::string& part) {
    throw Error(ErrorKind::invalid,
                fmt::format("phases: \"{}\" is not NAME=FROM:TO with a name of rest, pivot, stroke right, stroke down, "
                            "stroke away, trocar, and times in seconds",
                            part.substr(0, 60)));
  };
  std::vector<DeviceScript::Phase> out;
  std::istringstream parts(text);
  for (std::string whole; std::getline(parts, whole, ',');) {
    std::string_view part = whole;
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos) refuse(whole);
    DeviceScript::Phase phase;
    phase.name = std::string(part.substr(0, equals));
    part.remove_prefix(equals + 1);
    double from = 0.0, to = 0.0;
    bool good =
        std::any_of(guidedSteps.begin(), guidedSteps.end(), [&](const auto& s) { return phase.name == s.first; });
    good = good && takeSeconds(part, from) && part.starts_with(':');
    if (good) part.remove_prefix(1);
    if (!good || !takeSeconds(part, to) || !part.empty() || !(from < to)) refuse(whole);
    phase.from = nanosecondsOf(from);
    phase.to = nanosecondsOf(to);
    out.push_back(phase);
  }
  if (out.empty()) refuse(text);
  return out;
}

std::vector<DeviceScript::Phase> guidedPhases(double seconds) {
  std::vector<DeviceScript::Phase> out;
  double begin = 0.0;
  for (const auto& [name, length] : guidedSteps) {
    // A film ends a frame before its last step's end.
    if (begin + length > seconds + 0.2) break;
    out.push_back({name, nanosecondsOf(begin), nanosecondsOf(begin + length)});
    begin += length;
  }
  return out;
}

namespace {

constexpr std::size_t fewestTags = 10;
constexpr std::size_t mostViews = 30;
constexpr double stillPixels = 4.0;      // from frame to frame
constexpr double differentShare = 0.04;  // of the image's width, from view to view

std::vector<SeenTag> boardTagsOf(std::vector<SeenTag> tags) {
  std::erase_if(
      tags, [](const SeenTag& t) { return t.id < firstBoardTag || t.id >= firstBoardTag + boardColumns * boardRows; });
  return tags;
}

/// Mean distance of the corners that both show; nothing where they share fewer than four tags.
std::optional<double> meanMotion(const std::vector<SeenTag>& a, const std::vector<SeenTag>& b) {
  double sum = 0.0;
  int count = 0;
  for (const SeenTag& x : a) {
    for (const SeenTag& y : b) {
      if (x.id != y.id) continue;
      for (std::size_t k = 0; k < 4; ++k) sum += (x.corner[k] - y.corner[k]).norm();
      ++count;
    }
  }
  if (count < 4) return std::nullopt;
  return sum / (4.0 * count);
}

/// Keeps views that are unlike those that are there; thins them out when there are too many.
class ViewPicker {
 public:
  explicit ViewPicker(int width) : different_(differentShare * width) {}

  /// @returns whether a picture that follows the last one is worth keeping
  bool offer(const std::vector<SeenTag>& tags) {
    const std::vector<SeenTag> before = std::exchange(last_, tags);
    if (tags.size() < fewestTags || kept_.size() >= mostViews) return false;
    const std::optional<double> motion = meanMotion(before, tags);
    if (!motion || *motion > stillPixels) return false;
    const bool unlike = std::all_of(kept_.begin(), kept_.end(), [&](const auto& other) {
      const std::optional<double> apart = meanMotion(other, tags);
      return !apart || *apart > different_;
    });
    if (unlike) kept_.push_back(tags);
    return unlike;
  }

 private:
  double different_;
  std::vector<SeenTag> last_;
  std::vector<std::vector<SeenTag>> kept_;
};

}  // namespace

std::vector<BoardView> boardViews(FrameSource& source) {
  const TagDetector detect = makeTagDetector();
  ViewPicker picker(source.width());
  std::vector<BoardView> out;
  Frame frame;
  while (source.next(std::chrono::nanoseconds(0), frame) == FrameStatus::frame) {
    std::vector<SeenTag> tags = boardTagsOf(detect(frame.image));
    if (picker.offer(tags)) out.push_back({frame.time, std::move(tags)});
  }
  return out;
}

void pairedViews(FrameSource& first, FrameSource& second, std::vector<BoardView>& ofFirst,
                 std::vector<BoardView>& ofSecond) {
  const TagDetector detect = makeTagDetector();
  ViewPicker picker(first.width());
  const auto near = static_cast<std::int64_t>(0.5e9 / std::max(first.rate(), second.rate()));
  Frame a, b;
  bool more = first.next(std::chrono::nanoseconds(0), a) == FrameStatus::frame &&
              second.next(std::chrono::nanoseconds(0), b) == FrameStatus::frame;
  while (more) {
    if (std::abs(a.time - b.time) <= near) {
      std::vector<SeenTag> mine = boardTagsOf(detect(a.image));
      if (picker.offer(mine)) {
        std::vector<SeenTag> theirs = boardTagsOf(detect(b.image));
        if (theirs.size() >= fewestTags) {
          ofFirst.push_back({a.time, std::move(mine)});
          ofSecond.push_back({b.time, std::move(theirs)});
        }
      }
      more = first.next(std::chrono::nanoseconds(0), a) == FrameStatus::frame &&
             second.next(std::chrono::nanoseconds(0), b) == FrameStatus::frame;
    } else if (a.time < b.time) {
      more = first.next(std::chrono::nanoseconds(0), a) == FrameStatus::frame;
    } else {
      more = second.next(std::chrono::nanoseconds(0), b) == FrameStatus::frame;
    }
  }
}

}  // namespace calot::recorder
