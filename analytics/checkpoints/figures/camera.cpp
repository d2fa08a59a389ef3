// SPDX-License-Identifier: GPL-3.0-or-later
// How the endoscope was held, and what was done out of its sight.
#include "analytics/checkpoints/checkpoint.h"
#include "sim/math/no_fused_pairs.h"  // first

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "analytics/checkpoints/camera_track.h"
#include "sim/instruments/instruments.h"

namespace calot::analytics {
namespace {

constexpr const char* fixedCamera = "the camera did not move";

CheckpointDefinition cameraDefinition(const char* name, const char* title, Direction direction, const char* formula) {
  return {
      .name = name,
      .title = title,
      .unit = "s",
      .displayUnit = "s",
      .displayFactor = 1.0,
      .direction = direction,
      .window = "whole attempt",
      .aggregation = Aggregation::attempt,
      .instruments = "none: the endoscope",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition = formula,
      .paperReading = "",
  };
}

const CheckpointDefinition& horizonDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition horizon = cameraDefinition(
        "camera-horizon", "Deviation of the horizon", Direction::lower,
        "mean of |angle| over steps, angle between the picture's vertical and the vertical of the scene's camera, seen "
        "along the view; without steps in which the view is within 3 degrees of that vertical");
    horizon.unit = "rad";
    horizon.displayUnit = "deg";
    horizon.displayFactor = 180.0 / std::numbers::pi;
    horizon.window = "whole attempt, where the camera moves in it";
    return horizon;
  }();
  return d;
}

const CheckpointDefinition& centringDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition centring = cameraDefinition(
        "camera-centring", "Time with the active tip in the middle of the picture", Direction::higher,
        "#{steps in which the active tip is nearer to the picture's centre than half of the field's radius} / #{steps "
        "with an active tip}; active: the tip whose hook carries current, else the faster one, if it moves at 5 mm/s "
        "or more");
    centring.unit = "1";
    centring.displayUnit = "%";
    centring.displayFactor = 100.0;
    centring.window = "steps with an active tip, where the camera moves in the attempt";
    centring.instruments = "the active one";
    return centring;
  }();
  return d;
}

const CheckpointDefinition& cameraPathDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition path = cameraDefinition("camera-path-length", "Path length of the endoscope's lens",
                                                 Direction::lower, "sum |p(n+1) - p(n)| over the steps, p the lens");
    path.unit = "m";
    path.displayUnit = "mm";
    path.displayFactor = 1000.0;
    path.window = "whole attempt, where the camera moves in it";
    return path;
  }();
  return d;
}

const CheckpointDefinition& tipOutDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition out = cameraDefinition(
        "tip-out-of-view", "Time with the instrument's tip out of view", Direction::lower,
        "step length * #{steps in which the instrument's simulated tip lies outside of the picture, or behind the "
        "lens}; what organs hide counts as in view");
    out.aggregation = Aggregation::hand;
    out.instruments = "each hand by itself";
    out.window = "whole attempt, while an instrument is mounted";
    return out;
  }();
  return d;
}

const CheckpointDefinition& burnedOutDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition out = cameraDefinition(
        "burned-out-of-view", "Cautery on tissue out of view", Direction::lower,
        "step length * #{steps and hands in which a hook carries current on tissue while its simulated tip lies "
        "outside of the picture, or behind the lens}; what organs hide counts as in view");
    out.instruments = "sum over instruments";
    out.window = "whole attempt, where current went into tissue";
    return out;
  }();
  return d;
}

const CheckpointDefinition& cutOutDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition out = cameraDefinition(
        "cut-out-of-view", "Clips, cuts and openings out of view", Direction::lower,
        "#{clips set or dropped, vessels cut, burned through or torn, vessels' walls injured and organs opened at a "
        "place outside of the picture, or behind the lens}; what organs hide counts as in view");
    out.unit = "1";
    out.displayUnit = "1";
    out.instruments = "union over instruments";
    return out;
  }();
  return d;
}

std::vector<CheckpointValue> notApplicable(const CheckpointDefinition& d, const AttemptEnd& end, const char* why) {
  return {makeMissing(d, "", end.origin, Availability::notApplicable, why)};
}

class CameraHorizon final : public Checkpoint {
 public:
  explicit CameraHorizon(const AttemptContext& context) : track_(context.scene.picture) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    track_.take(record);
    const std::optional<double> angle = recorder::horizonDeviation(track_.frame(), track_.camera());
    if (!angle) return;
    sum_ += std::abs(*angle);
    ++steps_;
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!track_.moved()) return notApplicable(horizonDefinition(), end, fixedCamera);
    if (steps_ == 0) return notApplicable(horizonDefinition(), end, "the view was along the vertical all the time");
    return {makeValue(horizonDefinition(), "", end.origin, sum_ / static_cast<double>(steps_))};
  }

 private:
  CameraTrack track_;
  double sum_ = 0.0;
  std::uint64_t steps_ = 0;
};

class CameraPath final : public Checkpoint {
 public:
  explicit CameraPath(const AttemptContext& context) : track_(context.scene.picture) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    track_.take(record);
    const Vec3& lens = track_.camera().position;
    if (last_) path_ += (lens - *last_).norm();
    last_ = lens;
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!track_.moved()) return notApplicable(cameraPathDefinition(), end, fixedCamera);
    return {makeValue(cameraPathDefinition(), "", end.origin, path_)};
  }

 private:
  CameraTrack track_;
  std::optional<Vec3> last_;
  double path_ = 0.0;
};

class CameraCentring final : public Checkpoint {
 public:
  explicit CameraCentring(const AttemptContext& context)
      : track_(context.scene.picture),
        stepSeconds_(context.tickSeconds * static_cast<double>(context.ticksPerStep)),
        tooOld_(whyTooOld(context, 3)) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    track_.take(record);
    const HandResult* active = nullptr;
    double fastest = activeSpeed;
    bool current = false;
    for (std::size_t h = 0; h < last_.size(); ++h) {
      const HandResult& hand = record.result.hand[h];
      if (hand.instrument == InstrumentKind::none) {
        last_[h].reset();
        continue;
      }
      const double speed = last_[h] ? (hand.tipSimulated - *last_[h]).norm() / stepSeconds_ : 0.0;
      last_[h] = hand.tipSimulated;
      const bool burns = hand.cautery != Cautery::off;
      if (burns ? !current || speed > fastest : !current && speed >= fastest) {
        active = &hand;
        fastest = speed;
      }
      current = current || burns;
    }
    if (active == nullptr) return;
    ++active_;
    centred_ += recorder::isInPicture(track_.frame(), track_.camera(), active->tipSimulated, 0.5) ? 1 : 0;
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!tooOld_.empty()) return notApplicable(centringDefinition(), end, tooOld_.c_str());
    if (!track_.moved()) return notApplicable(centringDefinition(), end, fixedCamera);
    if (active_ == 0) return notApplicable(centringDefinition(), end, "no tip was active");
    return {
        makeValue(centringDefinition(), "", end.origin, static_cast<double>(centred_) / static_cast<double>(active_))};
  }

 private:
  static constexpr double activeSpeed = 0.005;  ///< of an active tip (m/s)

  CameraTrack track_;
  double stepSeconds_;
  std::string tooOld_;
  std::array<std::optional<Vec3>, handCount> last_;  ///< tips of the step before
  std::uint64_t active_ = 0, centred_ = 0;
};

class TipOutOfView final : public Checkpoint {
 public:
  explicit TipOutOfView(const AttemptContext& context)
      : track_(context.scene.picture), stepSeconds_(context.tickSeconds * static_cast<double>(context.ticksPerStep)) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    track_.take(record);
    for (std::size_t h = 0; h < out_.size(); ++h) {
      const HandResult& hand = record.result.hand[h];
      if (hand.instrument == InstrumentKind::none) continue;
      mounted_[h] = true;
      out_[h] += track_.sees(hand.tipSimulated) ? 0 : 1;
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const CheckpointDefinition& d = tipOutDefinition();
    std::vector<CheckpointValue> result;
    for (std::size_t h = 0; h < out_.size(); ++h) {
      result.push_back(
          mounted_[h]
              ? makeValue(d, handNames[h], end.origin, stepSeconds_ * static_cast<double>(out_[h]), stretchNote(end))
              : makeMissing(d, handNames[h], end.origin, Availability::absentHand, "no instrument in this hand"));
    }
    return result;
  }

 private:
  CameraTrack track_;
  double stepSeconds_;
  std::array<bool, handCount> mounted_{};
  std::array<std::uint64_t, handCount> out_{};  ///< steps
};

class BurnedOutOfView final : public Checkpoint {
 public:
  explicit BurnedOutOfView(const AttemptContext& context)
      : track_(context.scene.picture),
        stepSeconds_(context.tickSeconds * static_cast<double>(context.ticksPerStep)),
        tooOld_(whyTooOld(context, 3)) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    track_.take(record);
    for (const HandResult& hand : record.result.hand) {
      if (hand.cautery != Cautery::onTissue) continue;
      burned_ = true;
      out_ += track_.sees(hand.tipSimulated) ? 0 : 1;
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const CheckpointDefinition& d = burnedOutDefinition();
    if (!tooOld_.empty()) return notApplicable(d, end, tooOld_.c_str());
    if (!burned_) return notApplicable(d, end, "no current went into tissue");
    return {makeValue(d, "", end.origin, stepSeconds_ * static_cast<double>(out_), stretchNote(end))};
  }

 private:
  CameraTrack track_;
  double stepSeconds_;
  std::string tooOld_;
  bool burned_ = false;
  std::uint64_t out_ = 0;  ///< steps of both hands
};

class CutOutOfView final : public Checkpoint {
 public:
  explicit CutOutOfView(const AttemptContext& context)
      : track_(context.scene.picture), tooOld_(whyTooOld(context, 3)) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    track_.take(record);
    for (const Event& event : record.result.events) {
      switch (event.kind) {
        case EventKind::clipSet:
        case EventKind::clipDropped:
        case EventKind::vesselCut:
        case EventKind::vesselBurned:
        case EventKind::vesselTorn:
        case EventKind::wallInjured:
        case EventKind::organPerforated:
          any_ = true;
          out_ += track_.sees(event.position) ? 0 : 1;
          break;
        default:
          break;
      }
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const CheckpointDefinition& d = cutOutDefinition();
    if (!tooOld_.empty()) return notApplicable(d, end, tooOld_.c_str());
    if (!any_) return notApplicable(d, end, "nothing was clipped, cut or opened");
    return {makeValue(d, "", end.origin, static_cast<double>(out_))};
  }

 private:
  CameraTrack track_;
  std::string tooOld_;
  bool any_ = false;
  std::uint64_t out_ = 0;
};

template <class Kind>
std::unique_ptr<Checkpoint> make(const AttemptContext& context) {
  return std::make_unique<Kind>(context);
}

}  // namespace

std::vector<CheckpointEntry> cameraEntries() {
  return {{{CheckpointFamily::motion, 180}, horizonDefinition(), make<CameraHorizon>},
          {{CheckpointFamily::motion, 190}, centringDefinition(), make<CameraCentring>},
          {{CheckpointFamily::motion, 200}, cameraPathDefinition(), make<CameraPath>},
          {{CheckpointFamily::safety, 100}, tipOutDefinition(), make<TipOutOfView>},
          {{CheckpointFamily::safety, 110}, burnedOutDefinition(), make<BurnedOutOfView>},
          {{CheckpointFamily::safety, 120}, cutOutDefinition(), make<CutOutOfView>}};
}

}  // namespace calot::analytics
