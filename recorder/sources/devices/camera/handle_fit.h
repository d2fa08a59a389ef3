// SPDX-License-Identifier: GPL-3.0-or-later
// Pose of a rigid body with tags, from the corners that one or two cameras see.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "recorder/sources/devices/camera/camera_rig.h"
#include "sim/math/linear.h"

namespace calot::recorder {

/// A corner of a tag, seen.
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

/// exp of a rotation vector.
Quat rotationBy(const Vec3& vector);

/// Rotation of a plane from the images of its two axes: its first columns are the orthonormal pair closest to both
/// (least squares), M (M^T M)^(-1/2) of M = [across up], the third is their cross product. Not finite where they are
/// parallel.
Mat3 planeRotation(const Vec3& across, const Vec3& up);

}  // namespace calot::recorder
