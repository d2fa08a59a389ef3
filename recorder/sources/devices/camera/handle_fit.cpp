// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/handle_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "recorder/sources/devices/dense_solvers.h"
#include "recorder/sources/pointing.h"

namespace calot::recorder {
namespace {

using Pose6 = Eigen::Matrix<double, 6, 1>;
using Normal6 = Eigen::Matrix<double, 6, 6>;
constexpr double huberPixels = 1.0;
constexpr double cornerSigma = 0.3;  // pixels, of a corner of a clear picture
constexpr double nearest = 0.02;     // m, in front of a camera
constexpr int mostRounds = 40;

Mat3 crossMatrix(const Vec3& v) {
  Mat3 out;
  out << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return out;
}

struct Linearised {
  Normal6 normal = Normal6::Zero();
  Pose6 gradient = Pose6::Zero();
  double cost = 0.0, squares = 0.0;
};

/// @returns false where a corner lies behind its camera
bool linearise(const CameraRig& rig, std::span<const CornerSight> corners, const Pose& pose, const Twist& twist,
               const ShaftConstraint* shaft, Linearised& out) {
  out = {};
  for (const CornerSight& c : corners) {
    const RigCamera& camera = rig.cameras[c.camera];
    const Vec3 arm = pose.orientation * c.point;
    const Mat3 toCamera = camera.fromDevice.orientation.toRotationMatrix();
    const Vec3 k = inCamera(rig, c, pose, twist);
    if (!(k.z() > nearest)) return false;
    const Eigen::Vector2d focal = camera.lens.focal;
    const Eigen::Vector2d error = sightError(rig, c, k);
    Eigen::Matrix<double, 2, 3> slope;
    slope << focal.x() / k.z(), 0.0, -focal.x() * k.x() / (k.z() * k.z()),  //
        0.0, focal.y() / k.z(), -focal.y() * k.y() / (k.z() * k.z());
    Eigen::Matrix<double, 2, 6> jacobian;
    jacobian.leftCols<3>() = slope * toCamera;
    jacobian.rightCols<3>() = -jacobian.leftCols<3>() * crossMatrix(arm);
    const double size = error.norm();
    const double weight = size > huberPixels ? huberPixels / size : 1.0;
    out.cost += size > huberPixels ? huberPixels * (2.0 * size - huberPixels) : size * size;
    out.squares += size * size;
    out.normal += weight * jacobian.transpose() * jacobian;
    out.gradient += weight * jacobian.transpose() * error;
  }
  if (shaft != nullptr) {
    const Mat3 back = pose.orientation.toRotationMatrix().transpose();
    const Vec3 away = shaft->trocar - pose.position;
    const double weight = cornerSigma / shaft->sigma;
    Eigen::Matrix<double, 2, 6> jacobian;
    jacobian.leftCols<3>() = -weight * back.topRows<2>();
    jacobian.rightCols<3>() = weight * (back * crossMatrix(away)).topRows<2>();
    const Eigen::Vector2d error = weight * (back * away).head<2>();
    out.cost += error.squaredNorm();
    out.normal += jacobian.transpose() * jacobian;
    out.gradient += jacobian.transpose() * error;
  }
  return std::isfinite(out.cost);
}

Pose moved(const Pose& pose, const Pose6& step) {
  return {pose.position + step.head<3>(), (rotationBy(step.tail<3>()) * pose.orientation).normalized()};
}

}  // namespace

Vec3 inCamera(const CameraRig& rig, const CornerSight& corner, const Pose& body, const Twist& twist) {
  const Pose& camera = rig.cameras[corner.camera].fromDevice;
  const Vec3 arm = body.orientation * corner.point;
  const Vec3 x = body.position + arm + corner.later * (twist.velocity + twist.angular.cross(arm));
  return camera.position + camera.orientation * x;
}

Eigen::Vector2d sightError(const CameraRig& rig, const CornerSight& corner, const Vec3& inCamera) {
  const CameraLens& lens = rig.cameras[corner.camera].lens;
  return lens.focal.cwiseProduct(inCamera.head<2>() / inCamera.z() - corner.direction);
}

Quat rotationBy(const Vec3& vector) {
  const double angle = vector.norm();
  if (angle < 1e-12) return Quat(1.0, 0.5 * vector.x(), 0.5 * vector.y(), 0.5 * vector.z()).normalized();
  const double s = std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), s * vector.x(), s * vector.y(), s * vector.z()};
}

Vec3 rotationVector(const Quat& q) {
  const Vec3 v = q.w() < 0.0 ? Vec3(-q.vec()) : Vec3(q.vec());
  const double sine = v.norm();
  return sine < 1e-12 ? Vec3(2.0 * v) : Vec3(2.0 * std::atan2(sine, std::abs(q.w())) / sine * v);
}

std::optional<PoseFit> fitPose(const CameraRig& rig, std::span<const CornerSight> corners, const Pose& start,
                               const Twist& twist, const ShaftConstraint* shaft) {
  Pose pose = start;
  Linearised here;
  if (corners.size() < 4 || !linearise(rig, corners, pose, twist, shaft, here)) return std::nullopt;
  double damping = 1e-3;
  for (int round = 0; round < mostRounds; ++round) {
    Normal6 damped = here.normal;
    damped.diagonal() += damping * here.normal.diagonal();
    const Pose6 step = -solved(damped, here.gradient);
    if (!step.allFinite()) return std::nullopt;
    const Pose next = moved(pose, step);
    Linearised there;
    if (linearise(rig, corners, next, twist, shaft, there) && there.cost < here.cost) {
      const bool done = here.cost - there.cost < 1e-9 * (1.0 + here.cost);
      pose = next;
      here = there;
      damping = std::max(1e-9, 0.1 * damping);
      if (done) break;
    } else {
      damping *= 10.0;
      if (damping > 1e8) break;
    }
  }
  PoseFit out;
  out.pose = pose;
  out.cost = here.cost;
  out.residual = std::sqrt(here.squares / static_cast<double>(corners.size()));
  const SymmetricEigen normal = eigenOf(here.normal);
  if (!(normal.values[0] > 1e-15 * normal.values[5])) return std::nullopt;
  const Eigen::MatrixXd covariance = inverseOf(here.normal).topLeftCorner(3, 3);
  const double noise = std::max(cornerSigma, out.residual / std::sqrt(2.0));
  const double largest = eigenOf(covariance).values[2];
  out.uncertainty = noise * std::sqrt(std::max(0.0, largest));
  return out;
}

std::vector<Pose> posesOfSquare(const CameraRig& rig, std::span<const CornerSight> corners) {
  if (corners.size() != 4) return {};
  // Coordinates of the corners in their plane.
  const Vec3 middle = 0.25 * (corners[0].point + corners[1].point + corners[2].point + corners[3].point);
  const Vec3 right = (corners[1].point - corners[0].point).normalized();
  const Vec3 down = (corners[0].point - corners[3].point).normalized();
  // Homography from the plane to directions with its last element 1: the tag's middle lies in front of the camera.
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(8, 8);
  Eigen::VectorXd seen(8);
  const double unit = (corners[1].point - corners[0].point).norm();
  for (int i = 0; i < 4; ++i) {
    const CornerSight& c = corners[static_cast<std::size_t>(i)];
    const Eigen::RowVector3d at(right.dot(c.point - middle) / unit, down.dot(c.point - middle) / unit, 1.0);
    equations.block<1, 3>(2 * i, 0) = at;
    equations.block<1, 2>(2 * i, 6) = -c.direction.x() * at.head<2>();
    equations.block<1, 3>(2 * i + 1, 3) = at;
    equations.block<1, 2>(2 * i + 1, 6) = -c.direction.y() * at.head<2>();
    seen.segment<2>(2 * i) = c.direction;
  }
  const Eigen::VectorXd h = solved(equations, seen);
  Mat3 homography;
  homography << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0;
  const double size = 0.5 * (homography.col(0).norm() + homography.col(1).norm());
  const Mat3 rotation = planeRotation(homography.col(0), homography.col(1));
  const Vec3 translation = unit / size * homography.col(2);  // of the tag's middle, in the camera
  if (!rotation.allFinite() || !(translation.z() > nearest)) return {};

  Mat3 inBody;
  inBody << right, down, right.cross(down);
  const Pose& camera = rig.cameras[corners[0].camera].fromDevice;
  const auto inDevice = [&](const Mat3& turn) {
    const Quat body = quaternionOf(turn * inBody.transpose());
    const Vec3 position = translation - body * middle;
    return Pose{camera.orientation.conjugate() * (position - camera.position), camera.orientation.conjugate() * body};
  };
  const Vec3 sight = translation.normalized();
  const Vec3 normal = rotation.col(2);
  const Vec3 mirrored = 2.0 * normal.dot(sight) * sight - normal;
  const double cosine = normal.dot(mirrored);
  if (!(1.0 + cosine > 1e-9)) return {inDevice(rotation)};  // edge-on
  const Mat3 axis = crossMatrix(normal.cross(mirrored));    // of the smallest rotation of one onto the other
  const Mat3 turn = Mat3::Identity() + axis + axis * axis / (1.0 + cosine);
  return {inDevice(rotation), inDevice(turn * rotation)};
}

Mat3 planeRotation(const Vec3& across, const Vec3& up) {
  // The square root of a positive 2x2 matrix S is (S + d I) / sqrt(tr S + 2 d) with d = sqrt(det S).
  const double aa = across.squaredNorm(), uu = up.squaredNorm(), au = across.dot(up);
  const double d = std::sqrt(aa * uu - au * au);
  const double scale = 1.0 / (d * std::sqrt(aa + uu + 2.0 * d));
  Mat3 rotation;
  rotation.col(0) = scale * ((uu + d) * across - au * up);
  rotation.col(1) = scale * ((aa + d) * up - au * across);
  rotation.col(2) = rotation.col(0).cross(rotation.col(1));
  return rotation;
}

}  // namespace calot::recorder
