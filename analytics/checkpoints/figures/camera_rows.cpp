// SPDX-License-Identifier: GPL-3.0-or-later
// How the endoscope was held, and what was done out of its sight.
#include "analytics/checkpoints/figures/rows.h"
#include "sim/math/no_fused_pairs.h"  // first

#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "recorder/sources/scope/endoscope.h"
#include "sim/scene/description.h"

namespace calot::analytics {
namespace {

constexpr const char* fixedCamera = "the camera did not move";

/// The endoscope, step by step: the pose of each step's last tick, which is what a picture of it shows.
class CameraTrack {
 public:
  explicit CameraTrack(const AttemptContext& context)
      : frame_(context.scene.picture), camera_(context.scene.picture.start) {}

  void add(const recorder::StepRecord& record) {
    if (record.samples.empty()) return;
    const CameraSample& newest = record.samples.back().camera;
    if (!isMeasurement(newest)) return;  // the pose before is held, as in the simulation
    camera_ = newest;
    if (!any_) first_ = newest;
    any_ = true;
    moved_ = moved_ || newest.position != first_.position || newest.orientation.coeffs() != first_.orientation.coeffs();
  }

  [[nodiscard]] const CameraSample& camera() const { return camera_; }
  /// A step had another pose than the first one.
  [[nodiscard]] bool moved() const { return moved_; }
  /// The point is inside the picture; inside the inner half of its radius.
  [[nodiscard]] bool sees(const Vec3& p_W) const { return recorder::isInPicture(frame_, camera_, p_W); }
  [[nodiscard]] bool centres(const Vec3& p_W) const { return recorder::isInPicture(frame_, camera_, p_W, 0.5); }
  [[nodiscard]] std::optional<double> horizon() const { return recorder::horizonDeviation(frame_, camera_); }

 private:
  recorder::PictureFrame frame_;
  CameraSample camera_, first_;
  bool any_ = false, moved_ = false;
};

struct CameraHorizon {
  const AttemptContext& context;
  CameraTrack track{context};
  double sum = 0.0;
  std::uint64_t steps = 0;

  void add(const recorder::StepRecord& record) {
    track.add(record);
    const std::optional<double> angle = track.horizon();
    if (!angle) return;
    sum += std::abs(*angle);
    ++steps;
  }
  [[nodiscard]] Measured figure() const {
    if (!track.moved()) return Measured::notApplicable(fixedCamera);
    if (steps == 0) return Measured::notApplicable("the view was along the vertical all the time");
    return Measured::of(sum / static_cast<double>(steps));
  }
};

struct CameraPath {
  const AttemptContext& context;
  CameraTrack track{context};
  std::optional<Vec3> last = {};
  double path = 0.0;

  void add(const recorder::StepRecord& record) {
    track.add(record);
    const Vec3& lens = track.camera().position;
    if (last) path += (lens - *last).norm();
    last = lens;
  }
  [[nodiscard]] Measured figure() const {
    return track.moved() ? Measured::of(path) : Measured::notApplicable(fixedCamera);
  }
};

struct CameraCentring {
  static constexpr double activeSpeed = 0.005;  ///< of an active tip (m/s)

  const AttemptContext& context;
  CameraTrack track{context};
  std::array<std::optional<Vec3>, handCount> last = {};  ///< tips of the step before
  std::uint64_t active = 0, centred = 0;

  void add(const recorder::StepRecord& record) {
    track.add(record);
    const HandResult* activeHand = nullptr;
    double fastest = activeSpeed;
    bool current = false;
    for (std::size_t h = 0; h < last.size(); ++h) {
      const HandResult& hand = record.result.hand[h];
      if (hand.instrument == InstrumentKind::none) {
        last[h].reset();
        continue;
      }
      const double speed = last[h] ? (hand.tipSimulated - *last[h]).norm() / context.stepSeconds() : 0.0;
      last[h] = hand.tipSimulated;
      const bool burns = hand.cautery != Cautery::off;
      if (burns ? !current || speed > fastest : !current && speed >= fastest) {
        activeHand = &hand;
        fastest = speed;
      }
      current = current || burns;
    }
    if (activeHand == nullptr) return;
    ++active;
    centred += track.centres(activeHand->tipSimulated) ? 1 : 0;
  }
  [[nodiscard]] Measured figure() const {
    if (!track.moved()) return Measured::notApplicable(fixedCamera);
    if (active == 0) return Measured::notApplicable("no tip was active");
    return Measured::of(static_cast<double>(centred) / static_cast<double>(active));
  }
};

struct TipOutOfView {
  const AttemptContext& context;
  CameraTrack track{context};
  std::array<bool, handCount> mounted{};
  std::array<std::uint64_t, handCount> out{};  ///< steps

  void add(const recorder::StepRecord& record) {
    track.add(record);
    for (std::size_t h = 0; h < out.size(); ++h) {
      const HandResult& hand = record.result.hand[h];
      if (hand.instrument == InstrumentKind::none) continue;
      mounted[h] = true;
      out[h] += track.sees(hand.tipSimulated) ? 0 : 1;
    }
  }
  [[nodiscard]] Measured figure(const AttemptEnd& end, std::size_t h) const {
    if (!mounted[h]) return Measured::none(Availability::absentHand, "no instrument in this hand");
    return Measured::of(context.stepSeconds() * static_cast<double>(out[h]), stretchNote(end));
  }
};

struct BurnedOutOfView {
  const AttemptContext& context;
  CameraTrack track{context};
  bool burned = false;
  std::uint64_t out = 0;  ///< steps of both hands

  void add(const recorder::StepRecord& record) {
    track.add(record);
    for (const HandResult& hand : record.result.hand) {
      if (hand.cautery != Cautery::onTissue) continue;
      burned = true;
      out += track.sees(hand.tipSimulated) ? 0 : 1;
    }
  }
  [[nodiscard]] Measured figure(const AttemptEnd& end) const {
    if (!burned) return Measured::notApplicable("no current went into tissue");
    return Measured::of(context.stepSeconds() * static_cast<double>(out), stretchNote(end));
  }
};

struct CutOutOfView {
  const AttemptContext& context;
  CameraTrack track{context};
  bool any = false;
  std::uint64_t out = 0;

  void add(const recorder::StepRecord& record) {
    track.add(record);
    for (const Event& event : record.result.events) {
      switch (event.kind) {
        case EventKind::clipSet:
        case EventKind::clipDropped:
        case EventKind::vesselCut:
        case EventKind::vesselBurned:
        case EventKind::vesselTorn:
        case EventKind::wallInjured:
        case EventKind::organPerforated:
          any = true;
          out += track.sees(event.position) ? 0 : 1;
          break;
        default:
          break;
      }
    }
  }
  [[nodiscard]] Measured figure() const {
    return any ? Measured::of(static_cast<double>(out)) : Measured::notApplicable("nothing was clipped, cut or opened");
  }
};

}  // namespace

std::vector<CheckpointEntry> cameraRows() {
  constexpr const char* whereItMoves = "whole attempt, where the camera moves in it";
  constexpr const char* endoscope = "none: the endoscope";
  return {
      {.place = {CheckpointFamily::motion, 180},
       .definition = {.name = "camera-horizon",
                      .title = "Deviation of the horizon",
                      .displayUnit = "deg",
                      .direction = Direction::lower,
                      .window = whereItMoves,
                      .instruments = endoscope,
                      .definition = "mean of |angle| over steps, angle between the picture's vertical and the vertical "
                                    "of the scene's camera, seen along the view; without steps in which the view is "
                                    "within 3 degrees of that vertical"},
       .accumulate = accumulating<CameraHorizon>()},
      {.place = {CheckpointFamily::motion, 190},
       .definition = {.name = "camera-centring",
                      .title = "Time with the active tip in the middle of the picture",
                      .displayUnit = "%",
                      .direction = Direction::higher,
                      .window = "steps with an active tip, where the camera moves in the attempt",
                      .instruments = "the active one",
                      .definition = "#{steps in which the active tip is nearer to the picture's centre than half of "
                                    "the field's radius} / #{steps with an active tip}; active: the tip whose hook "
                                    "carries current, else the faster one, if it moves at 5 mm/s or more"},
       .results = 3,
       .accumulate = accumulating<CameraCentring>()},
      {.place = {CheckpointFamily::motion, 200},
       .definition = {.name = "camera-path-length",
                      .title = "Path length of the endoscope's lens",
                      .displayUnit = "mm",
                      .direction = Direction::lower,
                      .window = whereItMoves,
                      .instruments = endoscope,
                      .definition = "sum |p(n+1) - p(n)| over the steps, p the lens"},
       .accumulate = accumulating<CameraPath>()},
      {.place = {CheckpointFamily::safety, 100},
       .definition = {.name = "tip-out-of-view",
                      .title = "Time with the instrument's tip out of view",
                      .unit = "s",
                      .direction = Direction::lower,
                      .window = "whole attempt, while an instrument is mounted",
                      .aggregation = Aggregation::hand,
                      .instruments = "each hand by itself",
                      .definition = "step length * #{steps in which the instrument's simulated tip lies outside of the "
                                    "picture, or behind the lens}; what organs hide counts as in view"},
       .accumulate = accumulating<TipOutOfView>()},
      {.place = {CheckpointFamily::safety, 110},
       .definition = {.name = "burned-out-of-view",
                      .title = "Cautery on tissue out of view",
                      .unit = "s",
                      .direction = Direction::lower,
                      .window = "whole attempt, where current went into tissue",
                      .instruments = "sum over instruments",
                      .definition = "step length * #{steps and hands in which a hook carries current on tissue while "
                                    "its simulated tip lies outside of the picture, or behind the lens}; what organs "
                                    "hide counts as in view"},
       .results = 3,
       .accumulate = accumulating<BurnedOutOfView>()},
      {.place = {CheckpointFamily::safety, 120},
       .definition = {.name = "cut-out-of-view",
                      .title = "Clips, cuts and openings out of view",
                      .direction = Direction::lower,
                      .domain = Domain::whole,
                      .definition = "#{clips set or dropped, vessels cut, burned through or torn, vessels' walls "
                                    "injured and organs opened at a place outside of the picture, or behind the lens}; "
                                    "what organs hide counts as in view"},
       .results = 3,
       .accumulate = accumulating<CutOutOfView>()},
  };
}

}  // namespace calot::analytics
