// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/handle_tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/recorder/sources/devices/camera/support/marker_scene.h"

namespace calot::recorder {
namespace {

using cameratest::handMotion;
using cameratest::rigOfCameras;

double turnOf(const Quat& a, const Quat& b) { return 2.0 * std::acos(std::min(1.0, std::abs(a.dot(b)))); }

/// The corners of the tags that face the camera, without error.
std::vector<CornerSight> exactSights(const CameraRig& rig, const Pose& pose, std::size_t mostTags) {
  std::vector<CornerSight> out;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const RigCamera& camera = rig.cameras[c];
    for (const TagPlace& tag : handleTags(Hand::right)) {
      const auto inCamera = [&](const Vec3& x) {
        return Vec3(camera.fromDevice.position +
                    camera.fromDevice.orientation * (pose.position + pose.orientation * x));
      };
      const Vec3 normal = camera.fromDevice.orientation * (pose.orientation * tag.normal());
      const Vec3 middle = inCamera(tag.middle);
      if (normal.dot(middle) > -0.2 * middle.norm() || out.size() >= 4 * mostTags) continue;
      for (int k = 0; k < 4; ++k) {
        const Vec3 at = inCamera(tag.corner(k));
        out.push_back({c, tag.id, tag.corner(k), undistorted(camera.lens, projected(camera.lens, at)), 0.0});
      }
    }
  }
  return out;
}

TEST(HandleGeometry, TagsFaceOutwardsAndHaveNumbersOfTheirOwn) {
  std::set<int> ids;
  for (const Hand hand : {Hand::left, Hand::right}) {
    for (const TagPlace& tag : handleTags(hand)) {
      EXPECT_TRUE(ids.insert(tag.id).second);
      EXPECT_NEAR(tag.normal().dot(tag.middle.normalized()), tag.id % 20 == capTag ? 1.0 : std::sqrt(0.5), 1e-12)
          << tag.id;
      EXPECT_NEAR(tag.normal().norm(), 1.0, 1e-12);
    }
    EXPECT_TRUE(ids.insert(flapAt(hand, 0.0).id).second);
    // Closed, the flap continues face 0 towards the tip; opened, it swings outwards.
    EXPECT_NEAR(flapAt(hand, 0.0).normal().x(), 1.0, 1e-12);
    EXPECT_GT(flapAt(hand, 0.5).middle.x(), flapAt(hand, 0.0).middle.x());
  }
  for (const TagPlace& tag : boardTags()) EXPECT_TRUE(ids.insert(tag.id).second);
}

TEST(CameraLensModel, UndistortingUndoesTheLens) {
  const CameraLens lens = cameratest::webcam();
  for (double x = -0.6; x <= 0.6; x += 0.1) {
    for (double y = -0.35; y <= 0.35; y += 0.07) {
      const Eigen::Vector2d back = undistorted(lens, projected(lens, 0.4 * Vec3(x, y, 1.0)));
      EXPECT_NEAR(back.x(), x, 1e-9);
      EXPECT_NEAR(back.y(), y, 1e-9);
    }
  }
}

TEST(HandleFit, ExactCornersGiveTheExactPose) {
  for (const int cameras : {1, 2}) {
    const CameraRig rig = rigOfCameras(cameras);
    for (double t = 0.0; t < 6.0; t += 0.37) {
      const Pose truth = handMotion(Hand::right, t);
      const std::vector<CornerSight> sights = exactSights(rig, truth, 40);
      ASSERT_GE(sights.size(), 8U);
      double nearest = 1e9;
      for (const Pose& start : posesOfSquare(rig, std::span(sights).first(4))) {
        const std::optional<PoseFit> fit = fitPose(rig, sights, start, {}, nullptr);
        if (!fit || fit->residual > 1e-3) continue;
        nearest = std::min(
            nearest, (fit->pose.position - truth.position).norm() + turnOf(fit->pose.orientation, truth.orientation));
      }
      EXPECT_LT(nearest, 1e-6) << cameras << " cameras, " << t << " s";
    }
  }
}

TEST(HandleFit, MotionBetweenRowsAndCamerasIsAccountedFor) {
  const CameraRig rig = rigOfCameras(2);
  const Pose truth = handMotion(Hand::right, 1.0);
  const Twist twist{Vec3(0.3, -0.1, 0.05), Vec3(0.5, 1.0, -0.7)};
  const double later = 0.004;
  // The second camera sees the handle 4 ms later, elsewhere.
  const Pose moved{truth.position + later * twist.velocity,
                   (rotationBy(later * twist.angular) * truth.orientation).normalized()};
  std::vector<CornerSight> sights;
  for (const CornerSight& s : exactSights(rig, truth, 40)) {
    if (s.camera == 0) sights.push_back(s);
  }
  for (CornerSight s : exactSights(rig, moved, 40)) {
    if (s.camera == 0) continue;
    s.later = later;
    sights.push_back(s);
  }
  const std::optional<PoseFit> with = fitPose(rig, sights, truth, twist, nullptr);
  const std::optional<PoseFit> without = fitPose(rig, sights, truth, {}, nullptr);
  ASSERT_TRUE(with && without);
  EXPECT_LT((with->pose.position - truth.position).norm(), 2e-5);
  EXPECT_GT((without->pose.position - truth.position).norm(), 3e-4);
  EXPECT_GT(without->residual, 10.0 * with->residual);
}

TEST(HandleFit, TheTrocarMakesOneCameraMoreExact) {
  const CameraRig rig = rigOfCameras(1);
  Random random(11);
  double free = 0.0, held = 0.0;
  for (double t = 0.0; t < 4.0; t += 0.1) {
    const Pose truth = handMotion(Hand::right, t);
    std::vector<CornerSight> sights = exactSights(rig, truth, 40);
    for (CornerSight& s : sights) s.direction += 0.4 / 910.0 * Eigen::Vector2d(random.normal(), random.normal());
    const ShaftConstraint shaft{truth.position + truth.orientation * Vec3(0.0, 0.0, 0.2), 0.001};
    const std::optional<PoseFit> a = fitPose(rig, sights, truth, {}, nullptr),
                                 b = fitPose(rig, sights, truth, {}, &shaft);
    ASSERT_TRUE(a && b);
    free += (a->pose.position - truth.position).squaredNorm();
    held += (b->pose.position - truth.position).squaredNorm();
    // The fit's own uncertainty says how far it may be off.
    EXPECT_LT((a->pose.position - truth.position).norm(), 5.0 * a->uncertainty);
  }
  EXPECT_LT(held, 0.85 * free);
}

}  // namespace
}  // namespace calot::recorder
