// SPDX-License-Identifier: GPL-3.0-or-later
// Pose of a rigid body with tags, from the corners that one or two cameras see.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "recorder/sources/devices/camera/camera_rig.h"
#include "recorder/sources/devices/camera/frame_source.h"
#include "sim/math/linear.h"

namespace calot::recorder {

struct CornerSight {
  std::size_t camera = 0;
  int tag = 0;
  Vec3 point = Vec3::Zero();                            ///< in the body's frame (m)
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();  ///< undistorted, as (x / z, y / z) of the camera
  double later = 0.0;                                   ///< seen so long after the time that the pose is for (s)
};

/// Motion of a body in D; the corners are not all seen at the same time.
struct Twist {
  Vec3 velocity = Vec3::Zero();  ///< of the origin (m/s)
  Vec3 angular = Vec3::Zero();   ///< rad/s
};

/// Position of a corner in the frame of its camera, when it was seen (m).
Vec3 inCamera(const CameraRig& rig, const CornerSight& corner, const Pose& body, const Twist& twist);

/// How far it is seen from there, without the lens' distortion (pixels). @pre it lies in front of the camera
Eigen::Vector2d sightError(const CameraRig& rig, const CornerSight& corner, const Vec3& inCamera);

struct PoseFit {
  Pose pose;                 ///< of the body in D
  double residual = 0.0;     ///< root mean square distance of the corners (pixels)
  double cost = 0.0;         ///< robust cost
  double uncertainty = 0.0;  ///< largest standard deviation of the position in a direction (m)
};

/// Shaft along the body's z axis that passes through a trocar.
struct ShaftConstraint {
  Vec3 trocar = Vec3::Zero();  ///< in D (m)
  double sigma = 0.002;        ///< how far the shaft may pass it by (m)
};

/// Robust least squares (Levenberg and Marquardt; Huber's weights beyond a pixel) over all corners, the trocar as two
/// residuals more.
/// @returns nothing where a corner comes to lie behind a camera or the iteration fails
std::optional<PoseFit> fitPose(const CameraRig& rig, std::span<const CornerSight> corners, const Pose& start,
                               const Twist& twist, const ShaftConstraint* shaft);

/// Both poses of a plane square that four of its corners allow, best first: a square alone is seen nearly the same when
/// its tilt is mirrored about the line of sight (Collins and Bartoli 2014, "Infinitesimal plane-based pose estimation",
/// IJCV 109:252).
/// @param corners the four of one tag, in order. @returns poses of the body in D
std::vector<Pose> posesOfSquare(const CameraRig& rig, std::span<const CornerSight> corners);

/// exp of a rotation vector, and its inverse: of the shorter way.
Quat rotationBy(const Vec3& vector);
Vec3 rotationVector(const Quat& rotation);

/// Rotation of a plane from the images of its two axes: its first columns are the orthonormal pair closest to both
/// (least squares), M (M^T M)^(-1/2) of M = [across up], the third is their cross product. Not finite where they are
/// parallel.
Mat3 planeRotation(const Vec3& across, const Vec3& up);

struct SeenFrame {
  std::size_t camera = 0;
  std::int64_t time = 0;  ///< exposure of the middle row (ns)
  std::vector<SeenTag> tags;
};

/// Reason why a handle has no pose.
enum class PoseFault : std::uint8_t {
  none,
  unseen,        ///< too few of its tags
  ambiguous,     ///< two poses explain what was seen
  inconsistent,  ///< no pose explains all that was seen
  uncertain,     ///< one does, but the position would be too uncertain
  leap,          ///< too far from where the handle was
};
const char* wordsFor(PoseFault fault);

struct HandleSight {
  PoseFault fault = PoseFault::unseen;
  std::int64_t time = 0;  ///< that the pose is for: mean of the corners' exposures (ns)
  Pose pose;              ///< q_DI, p_DI
  double residual = 0.0;  ///< pixels
  double uncertainty = 0.0;
  std::optional<double> jaw;  ///< angle of the flap (rad); nothing: not seen, or not trusted
};

/// Limits of what is believed.
struct TrackerLimits {
  double residual = 1.0;        ///< root mean square (pixels)
  double tagResidual = 2.5;     ///< of one tag; one that is beyond is left out, if enough remain (pixels)
  double uncertainty = 0.0025;  ///< m
  double ambiguity = 4.0;       ///< cost of the second pose per cost of the best, at least
  double speed = 2.0;           ///< m/s
  double turning = 20.0;        ///< rad/s
};

/// Poses of one hand's handle from frame to frame. A pose is believed only if it explains all that was seen, no other
/// one does nearly as well, and the handle can have come there; anything else has no pose.
class HandleTracker {
 public:
  HandleTracker(const CameraRig& rig, Hand hand, TrackerLimits limits = {});

  /// @param frames of the same moment, at most one of each camera
  HandleSight track(std::span<const SeenFrame> frames);

 private:
  struct Known {
    std::int64_t time = 0;
    Pose pose;
  };
  std::vector<CornerSight> cornersOf(std::span<const SeenFrame> frames, std::int64_t time) const;
  PoseFault choose(const std::vector<CornerSight>& corners, std::int64_t time, PoseFit& best) const;
  [[nodiscard]] Pose predicted(std::int64_t time) const;
  [[nodiscard]] bool reachable(const Known& from, const Pose& to, std::int64_t time) const;
  [[nodiscard]] std::optional<double> jawOf(std::span<const SeenFrame> frames, const HandleSight& sight) const;

  const CameraRig* rig_;
  Hand hand_;
  TrackerLimits limits_;
  std::vector<std::vector<Vec3>> point_;  ///< corners of each rigid tag, in I
  std::optional<Known> last_;             ///< believed
  Twist twist_;
  std::vector<Known> waiting_;  ///< beyond reach of the last one, but each within reach of the one before it
};

}  // namespace calot::recorder
