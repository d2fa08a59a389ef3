// SPDX-License-Identifier: GPL-3.0-or-later
// The endoscope's geometry, its motion, and the assistant who holds it.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "recorder/sources/scope/scope_source.h"
#include "tests/recorder/sources/support/test_scene.h"

namespace calot::recorder {
namespace {

constexpr double degree = 0.017453292519943295;

const SceneDescription& round() {
  static const SceneDescription scene = test::roundScene();
  return scene;
}

Vec3 viewOf(const CameraSample& camera) { return camera.orientation * Vec3::UnitZ(); }

double degreesBetween(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) / degree; }

/// The endoscope's lens, seen from the port: the shaft.
Vec3 shaftOf(const Endoscope& endoscope, const CameraSample& camera) {
  return (camera.position - endoscope.port()).normalized();
}

std::vector<ScopeJoints> severalJoints() {
  return {{0.0, 0.0, 0.08, 0.0, 0.0},
          {0.4, -0.3, 0.05, 0.0, 0.2},
          {-0.5, 0.2, 0.12, 1.1, 0.0},
          {0.1, 0.6, 0.19, -2.2, -0.7}};
}

TEST(Endoscope, AStraightOneBeginsAsTheScenesCamera) {
  const Endoscope endoscope(round(), 0.0);
  const CameraSample start = endoscope.pose(endoscope.start());
  EXPECT_LT((start.position - round().camera.position).norm(), 1e-12);
  EXPECT_LT((start.orientation.toRotationMatrix() - round().camera.orientation.toRotationMatrix()).norm(), 1e-12);
}

TEST(Endoscope, AnAngledOneLooksAtTheSamePointFromAbove) {
  const Endoscope endoscope(round(), 30.0 * degree);
  const CameraSample start = endoscope.pose(endoscope.start());
  const Vec3 seen = round().camera.position + endoscope.workingDistance() * viewOf(round().camera);
  EXPECT_NEAR((seen - start.position).norm(), endoscope.workingDistance(), 1e-12);
  EXPECT_LT(degreesBetween(seen - start.position, viewOf(start)), 1e-6);
  const Vec3 up = round().camera.orientation * Vec3(0.0, -1.0, 0.0);
  EXPECT_GT((start.position - round().camera.position).dot(up), 0.01) << "from above";
  EXPECT_NEAR(*horizonDeviation(endoscope.frame(), start), 0.0, 1e-12);
}

TEST(Endoscope, TheShaftGoesThroughThePortWhateverMoves) {
  for (const double optic : {0.0, 30.0, 45.0}) {
    const Endoscope endoscope(round(), optic * degree);
    for (const ScopeJoints& joints : severalJoints()) {
      const CameraSample camera = endoscope.pose(joints);
      EXPECT_NEAR((camera.position - endoscope.port()).norm(), joints.insertion, 1e-12);
      EXPECT_NEAR(degreesBetween(shaftOf(endoscope, camera), viewOf(camera)), optic, 1e-5)
          << "the optic's angle between shaft and view";
    }
  }
}

TEST(Endoscope, TheLightCableRotatesTheViewAndTheHeadTheHorizon) {
  const Endoscope endoscope(round(), 30.0 * degree);
  ScopeJoints joints = endoscope.start();
  const CameraSample before = endoscope.pose(joints);
  joints.cable = 180.0 * degree;
  const CameraSample opposite = endoscope.pose(joints);
  EXPECT_NEAR(degreesBetween(viewOf(before), viewOf(opposite)), 60.0, 1e-6) << "from below to above the shaft";
  EXPECT_NEAR(*horizonDeviation(endoscope.frame(), opposite), 0.0, 1e-9) << "the head was not rotated";
  joints = endoscope.start();
  joints.head = 10.0 * degree;
  const CameraSample rolled = endoscope.pose(joints);
  EXPECT_LT(degreesBetween(viewOf(before), viewOf(rolled)), 1e-6) << "the head leaves the view alone";
  EXPECT_NEAR(*horizonDeviation(endoscope.frame(), rolled) / degree, 10.0, 1e-9);
}

TEST(Endoscope, PanAndTiltKeepTheHorizon) {
  const Endoscope endoscope(round(), 30.0 * degree);
  for (const double pan : {-0.6, 0.0, 0.5}) {
    for (const double tilt : {-0.2, 0.3}) {
      const CameraSample camera = endoscope.pose({pan, tilt, 0.1, 0.0, 0.0});
      EXPECT_NEAR(*horizonDeviation(endoscope.frame(), camera), 0.0, 1e-12);
    }
  }
}

TEST(Endoscope, APoseGivesItsJointsBack) {
  for (const double optic : {0.0, 30.0}) {
    const Endoscope endoscope(round(), optic * degree);
    for (ScopeJoints joints : severalJoints()) {
      if (optic == 0.0) joints.cable = 0.0;  // changes nothing
      const ScopeJoints back = endoscope.jointsOf(endoscope.pose(joints));
      EXPECT_NEAR(back.pan, joints.pan, 1e-9);
      EXPECT_NEAR(back.tilt, joints.tilt, 1e-9);
      EXPECT_NEAR(back.insertion, joints.insertion, 1e-12);
      EXPECT_NEAR(back.cable, joints.cable, 1e-9);
      EXPECT_NEAR(back.head, joints.head, 1e-9);
    }
  }
}

TEST(Endoscope, IsAimedAtAPoint) {
  for (const double optic : {0.0, 30.0}) {
    const Endoscope endoscope(round(), optic * degree);
    const Vec3 point = round().camera.position + round().camera.orientation * Vec3(0.03, -0.02, 0.08);
    const CameraSample camera = endoscope.pose(endoscope.aimedAt(point, 0.07, endoscope.start()));
    const auto seen = pointInPicture(endoscope.frame(), camera, point);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->right, 0.0, 1e-9);
    EXPECT_NEAR(seen->down, 0.0, 1e-9);
    EXPECT_NEAR((point - camera.position).norm(), 0.07, 1e-9);
  }
}

TEST(PictureGeometry, EdgesOfThePicture) {
  const PictureFrame frame{{Vec3::Zero(), Quat::Identity()}, 90.0 * degree};
  const CameraSample camera = frame.start;
  EXPECT_TRUE(isInPicture(frame, camera, Vec3(0.0, 0.099, 0.1)));
  EXPECT_FALSE(isInPicture(frame, camera, Vec3(0.0, 0.101, 0.1)));
  EXPECT_TRUE(isInPicture(frame, camera, Vec3(0.1119, 0.0, 0.1))) << "the round field";
  EXPECT_FALSE(isInPicture(frame, camera, Vec3(0.1121, 0.0, 0.1)));
  EXPECT_FALSE(isInPicture(frame, camera, Vec3(0.08, 0.08, 0.1))) << "0.113 off the centre";
  EXPECT_FALSE(isInPicture(frame, camera, Vec3(0.0, 0.0, -0.1))) << "behind the lens";
  EXPECT_TRUE(isInPicture(frame, camera, Vec3(0.0, 0.055, 0.1), 0.5));
  EXPECT_FALSE(isInPicture(frame, camera, Vec3(0.0, 0.057, 0.1), 0.5));
  EXPECT_FALSE(horizonDeviation(frame, {Vec3::Zero(), Quat(Eigen::AngleAxisd(90.0 * degree, Vec3::UnitX()))}))
      << "a view along the vertical has no horizon";
}

TEST(ScopeMotion, IsSmoothAndWithinItsSpeedsAndLimits) {
  ScopeMotion motion;
  motion.setOut({0.0, 0.0, 0.08, 0.0, 0.0});
  ScopeJoints last = motion.joints();
  double fastest = 0.0, jump = 0.0, lastSpeed = 0.0;
  for (int tick = 0; tick < 5000; ++tick) {
    motion.advance({9.0, 0.0, 1.0, 0.0, 0.0});
    const double speed = (motion.joints().pan - last.pan) / tickLength;
    fastest = std::max(fastest, speed);
    if (motion.joints().pan < 1.0) jump = std::max(jump, std::abs(speed - lastSpeed));
    lastSpeed = speed;
    last = motion.joints();
  }
  EXPECT_NEAR(fastest, ScopeMotion::maxSwingSpeed, 1e-9);
  EXPECT_LT(jump, 0.1) << "no jump of the speed from tick to tick (rad/s)";
  EXPECT_NEAR(last.pan, Endoscope::maxSwing, 1e-6);
  EXPECT_NEAR(last.insertion, Endoscope::maxInsertion, 1e-6);
}

/// Hands that stand where a test wants them.
class StandingSource final : public SampleSource {
 public:
  [[nodiscard]] const Provenance& provenance() const override { return provenance_; }
  bool next(std::uint64_t tick, TickSamples& out) override {
    if (tick >= ticks) return false;
    for (InstrumentSample& hand : samples.hand) hand.position = tip;
    out = roundedToGrid(samples);
    return true;
  }
  std::uint64_t ticks = 6000;
  TickSamples samples;
  Vec3 tip = Vec3::Zero();

 private:
  Provenance provenance_;
};

std::vector<TickSamples> runOf(double optic, const Vec3& tip, const ScopeSkill& skill, std::uint64_t seed) {
  const Endoscope endoscope(round(), optic);
  auto hands = std::make_unique<StandingSource>();
  hands->tip = tip;
  ScopeSource source(std::move(hands), endoscope, std::make_unique<ScopeAssistant>(endoscope, skill, seed));
  std::vector<TickSamples> out;
  TickSamples samples;
  for (std::uint64_t tick = 0; source.next(tick, samples); ++tick) out.push_back(samples);
  return out;
}

TEST(ScopeAssistant, BringsWorkThatLeftThePictureToItsCentreAndHoldsTheHorizon) {
  const Vec3 tip = round().camera.position + round().camera.orientation * Vec3(0.07, 0.03, 0.09);
  const PictureFrame frame{round().camera, round().verticalFieldOfView};
  for (const double optic : {0.0, 30.0 * degree}) {
    const std::vector<TickSamples> run = runOf(optic, tip, {0.3, 0.3, 0.02}, 1);
    ASSERT_EQ(run.size(), 6000U);
    const auto before = pointInPicture(frame, run.front().camera, tip),
               after = pointInPicture(frame, run.back().camera, tip);
    ASSERT_TRUE(before && after);
    EXPECT_GT(std::hypot(before->right, before->down), 0.5);
    EXPECT_LT(std::hypot(after->right, after->down), 0.3);
    double sum = 0.0;
    for (const TickSamples& tick : run) sum += std::abs(*horizonDeviation(frame, tick.camera));
    EXPECT_GT(sum / 6000.0, 0.001);
    EXPECT_LT(sum / 6000.0, 0.06);
  }
}

TEST(ScopeAssistant, StaysWhereTheWorkIsInTheDeadZoneAndIsTheSameForTheSameSeed) {
  const Vec3 tip = round().camera.position + round().camera.orientation * Vec3(0.005, 0.0, 0.09);
  const std::vector<TickSamples> run = runOf(0.0, tip, {0.3, 0.4, 0.0}, 1);
  EXPECT_LT((run.back().camera.position - run.front().camera.position).norm(), 1e-5);
  const std::vector<TickSamples> a = runOf(0.0, tip, {0.3, 0.4, 0.05}, 7), b = runOf(0.0, tip, {0.3, 0.4, 0.05}, 7);
  for (std::size_t i = 0; i < a.size(); i += 100)
    EXPECT_EQ(a[i].camera.orientation.coeffs(), b[i].camera.orientation.coeffs());
}

TEST(ScopeSource, SetsOutFromAPoseThatWasRecorded) {
  const Endoscope endoscope(round(), 30.0 * degree);
  const CameraSample pose = endoscope.pose({0.3, 0.1, 0.1, 0.0, 0.0});
  auto hands = std::make_unique<StandingSource>();
  hands->tip = pose.position + pose.orientation * Vec3(0.0, 0.0, 0.08);
  ScopeSource source(std::move(hands), endoscope,
                     std::make_unique<ScopeAssistant>(endoscope, ScopeSkill{0.3, 0.4, 0.0}, 1));
  source.setOutFrom(pose);
  TickSamples samples;
  ASSERT_TRUE(source.next(0, samples));
  EXPECT_LT((samples.camera.position - pose.position).norm(), 2e-6);
  EXPECT_LT(degreesBetween(viewOf(samples.camera), viewOf(pose)), 0.01);
}

}  // namespace
}  // namespace calot::recorder
