// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/handle_tracker.h"

#include <algorithm>
#include <cmath>

#include "recorder/sources/devices/camera/marker_sheets.h"

namespace calot::recorder {
namespace {

constexpr double perSecond = 1e-9;
constexpr double rememberedSeconds = 0.3;  // an older pose predicts nothing
constexpr double leapRoom = 0.01;          // m, that noise may add to a motion
constexpr double turnRoom = 0.15;          // rad
constexpr double samePosition = 0.004;     // m; two minima closer than this and samePose are one
constexpr double samePose = 0.06;          // rad
constexpr double likelyTurn = 0.35;        // rad from the prediction: decides between two poses
constexpr std::size_t agreeing = 3;        // poses in a row overrule the one that was believed last
constexpr double shaftSigma = 0.002;       // m
constexpr double largestFlap = 1.5;        // rad

double turnBetween(const Quat& a, const Quat& b) { return 2.0 * std::acos(std::min(1.0, std::abs(a.dot(b)))); }

double rowDelay(const CameraLens& lens, double row) { return lens.readout * (row / lens.height - 0.5); }

/// Root mean square error of corners (pixels).
double residualOf(const CameraRig& rig, std::span<const CornerSight> corners, const Pose& pose, const Twist& twist) {
  double squares = 0.0;
  for (const CornerSight& c : corners) squares += sightError(rig, c, inCamera(rig, c, pose, twist)).squaredNorm();
  return std::sqrt(squares / static_cast<double>(corners.size()));
}

/// The tag that one camera sees farthest off, by its first corner's index.
struct TagError {
  double residual = 0.0;
  std::size_t first = 0;
};

TagError worstTag(const CameraRig& rig, const std::vector<CornerSight>& corners, const Pose& pose, const Twist& twist) {
  TagError worst;
  for (std::size_t i = 0; i < corners.size(); i += 4) {
    const double residual = residualOf(rig, std::span(corners).subspan(i, 4), pose, twist);
    if (residual > worst.residual) worst = {residual, i};
  }
  return worst;
}

/// Do all tags show their printed side?
bool allFaceTheirCamera(const CameraRig& rig, const std::vector<CornerSight>& corners, const Pose& pose) {
  for (std::size_t i = 0; i < corners.size(); i += 4) {
    const Pose& camera = rig.cameras[corners[i].camera].fromDevice;
    const Vec3 right = corners[i + 1].point - corners[i].point, down = corners[i].point - corners[i + 3].point;
    const Vec3 normal = camera.orientation * (pose.orientation * down.cross(right));
    const Vec3 at = inCamera(rig, corners[i], pose, {});
    if (!(normal.dot(at) < 0.0)) return false;
  }
  return true;
}

}  // namespace

const char* wordsFor(PoseFault fault) {
  constexpr std::array words{"",
                             "too few of its tags are seen",
                             "two poses explain what is seen",
                             "no pose explains what is seen",
                             "its position would be too uncertain",
                             "it would have leapt"};
  return words[static_cast<std::size_t>(fault)];
}

HandleTracker::HandleTracker(const CameraRig& rig, Hand hand, TrackerLimits limits)
    : rig_(&rig), hand_(hand), limits_(limits) {
  for (const TagPlace& tag : handleTags(hand, rig.printScale)) {
    std::vector<Vec3> corners;
    corners.reserve(4);
    for (int k = 0; k < 4; ++k) corners.push_back(tag.corner(k, tagSide * rig.printScale));
    point_.push_back(corners);
  }
}

std::vector<CornerSight> HandleTracker::cornersOf(std::span<const SeenFrame> frames, std::int64_t time) const {
  std::vector<CornerSight> out;
  for (const SeenFrame& frame : frames) {
    const CameraLens& lens = rig_->cameras[frame.camera].lens;
    for (const SeenTag& tag : frame.tags) {
      const int number = tag.id - firstTagOf(hand_);
      if (number < 0 || number >= static_cast<int>(point_.size())) continue;
      for (std::size_t k = 0; k < 4; ++k) {
        const double later = perSecond * static_cast<double>(frame.time - time) + rowDelay(lens, tag.corner[k].y());
        out.push_back({frame.camera, tag.id, point_[static_cast<std::size_t>(number)][k],
                       undistorted(lens, tag.corner[k]), later});
      }
    }
  }
  return out;
}

Pose HandleTracker::predicted(std::int64_t time) const {
  const double seconds = perSecond * static_cast<double>(time - last_->time);
  return {last_->pose.position + seconds * twist_.velocity,
          (rotationBy(seconds * twist_.angular) * last_->pose.orientation).normalized()};
}

bool HandleTracker::reachable(const Known& from, const Pose& to, std::int64_t time) const {
  const double seconds = perSecond * static_cast<double>(time - from.time);
  return (to.position - from.pose.position).norm() <= leapRoom + limits_.speed * seconds &&
         turnBetween(to.orientation, from.pose.orientation) <= turnRoom + limits_.turning * seconds;
}

PoseFault HandleTracker::choose(const std::vector<CornerSight>& corners, std::int64_t time, PoseFit& best) const {
  const std::optional<Trocar>& trocar = rig_->trocar[static_cast<std::size_t>(hand_)];
  const ShaftConstraint shaft{trocar ? trocar->point : Vec3::Zero(), shaftSigma};
  const bool known = last_ && perSecond * static_cast<double>(time - last_->time) <= rememberedSeconds;
  std::vector<Pose> starts;
  if (known) starts.push_back(predicted(time));
  for (std::size_t i = 0; i < corners.size(); i += 4) {
    for (const Pose& pose : posesOfSquare(*rig_, std::span(corners).subspan(i, 4))) starts.push_back(pose);
  }
  const Twist twist = known ? twist_ : Twist{};
  std::vector<PoseFit> fits;
  for (const Pose& start : starts) {
    const std::optional<PoseFit> fit = fitPose(*rig_, corners, start, twist, trocar ? &shaft : nullptr);
    if (fit && allFaceTheirCamera(*rig_, corners, fit->pose)) fits.push_back(*fit);
  }
  if (fits.empty()) return PoseFault::inconsistent;
  std::sort(fits.begin(), fits.end(), [](const PoseFit& a, const PoseFit& b) { return a.cost < b.cost; });
  best = fits.front();
  // Corners of a clear picture are off by a few tenths of a pixel: below that, costs say nothing.
  const double floor = 0.02 * static_cast<double>(corners.size());
  for (const PoseFit& other : fits) {
    const bool same = turnBetween(other.pose.orientation, best.pose.orientation) < samePose &&
                      (other.pose.position - best.pose.position).norm() < samePosition;
    if (same || other.cost >= limits_.ambiguity * (best.cost + floor)) continue;
    if (!known) return PoseFault::ambiguous;
    const Quat expected = predicted(time).orientation;
    const double toBest = turnBetween(expected, best.pose.orientation);
    const double toOther = turnBetween(expected, other.pose.orientation);
    if (toBest < likelyTurn && toOther > 2.0 * toBest) continue;
    return PoseFault::ambiguous;
  }
  return PoseFault::none;
}

HandleSight HandleTracker::track(std::span<const SeenFrame> frames) {
  HandleSight out;
  if (frames.empty()) return out;
  out.time = frames.front().time;
  std::vector<CornerSight> corners = cornersOf(frames, out.time);
  if (corners.empty()) return out;
  // The pose is for the mean of what was seen.
  double later = 0.0;
  for (const CornerSight& c : corners) later += c.later / static_cast<double>(corners.size());
  for (CornerSight& c : corners) c.later -= later;
  out.time += static_cast<std::int64_t>(std::floor(later / perSecond + 0.5));
  const bool known = last_ && perSecond * static_cast<double>(out.time - last_->time) <= rememberedSeconds;
  const Twist twist = known ? twist_ : Twist{};
  PoseFit fit;
  const std::size_t most = corners.size();
  for (;;) {
    // One tag that one camera sees is a plane square: a false one would not be noticed.
    if (corners.size() < 8) {
      out.fault = most < 8 ? PoseFault::unseen : PoseFault::inconsistent;
      return out;
    }
    out.fault = choose(corners, out.time, fit);
    if (out.fault == PoseFault::inconsistent) return out;
    const TagError worst = worstTag(*rig_, corners, fit.pose, twist);
    if (worst.residual <= limits_.tagResidual) break;
    // A minority may be false; more than that says that the pose is.
    if (corners.size() <= 12 || 3 * (corners.size() - 4) < 2 * most) {
      out.fault = PoseFault::inconsistent;
      return out;
    }
    const auto first = corners.begin() + static_cast<std::ptrdiff_t>(worst.first);
    corners.erase(first, first + 4);
  }
  if (out.fault != PoseFault::none) return out;
  out.pose = fit.pose;
  out.residual = fit.residual;
  out.uncertainty = fit.uncertainty;
  if (!(fit.uncertainty <= limits_.uncertainty)) out.fault = PoseFault::uncertain;
  if (!(fit.residual <= limits_.residual)) out.fault = PoseFault::inconsistent;
  if (out.fault != PoseFault::none) return out;
  const Known now{out.time, out.pose};
  if (last_ && !reachable(*last_, now.pose, now.time)) {
    if (!waiting_.empty() && !reachable(waiting_.back(), now.pose, now.time)) waiting_.clear();
    waiting_.push_back(now);
    if (waiting_.size() < agreeing) {
      out.fault = PoseFault::leap;
      return out;
    }
    last_.reset();
  }
  waiting_.clear();
  const double seconds = last_ ? perSecond * static_cast<double>(now.time - last_->time) : 0.0;
  twist_ = {};
  if (seconds > 0.0 && seconds <= rememberedSeconds) {
    twist_.velocity = (now.pose.position - last_->pose.position) / seconds;
    twist_.angular = rotationVector(now.pose.orientation * last_->pose.orientation.conjugate()) / seconds;
  }
  last_ = now;
  out.jaw = jawOf(frames, out);
  return out;
}

std::optional<double> HandleTracker::jawOf(std::span<const SeenFrame> frames, const HandleSight& sight) const {
  std::vector<CornerSight> seen;
  for (const SeenFrame& frame : frames) {
    for (const SeenTag& tag : frame.tags) {
      if (tag.id != firstTagOf(hand_) + flapTag) continue;
      for (const Eigen::Vector2d& corner : tag.corner)
        seen.push_back(
            {frame.camera, tag.id, Vec3::Zero(), undistorted(rig_->cameras[frame.camera].lens, corner), 0.0});
    }
  }
  if (seen.empty()) return std::nullopt;
  const auto residual = [&](double angle) {
    const TagPlace flap = flapAt(hand_, angle, rig_->printScale);
    for (std::size_t i = 0; i < seen.size(); ++i)
      seen[i].point = flap.corner(static_cast<int>(i % 4), tagSide * rig_->printScale);
    return residualOf(*rig_, seen, sight.pose, {});
  };
  // One unknown: a scan, then golden sections.
  constexpr int steps = 32;
  double best = 0.0, least = residual(0.0);
  for (int i = 1; i <= steps; ++i) {
    const double angle = largestFlap * i / steps, r = residual(angle);
    if (r < least) {
      least = r;
      best = angle;
    }
  }
  constexpr double golden = 0.6180339887498949;
  double lower = best - largestFlap / steps, upper = best + largestFlap / steps;
  for (int i = 0; i < 24; ++i) {
    const double a = upper - golden * (upper - lower), b = lower + golden * (upper - lower);
    if (residual(a) < residual(b)) {
      upper = b;
    } else {
      lower = a;
    }
  }
  const double angle = 0.5 * (lower + upper);
  if (!(residual(angle) <= limits_.tagResidual)) return std::nullopt;
  return std::max(0.0, angle);
}

}  // namespace calot::recorder
