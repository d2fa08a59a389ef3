// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of the endoscope against cases that are computed by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/analytics/checkpoints/support/operation.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using namespace support;

constexpr double degree = 0.017453292519943295;

/// The camera at the origin, along z; the picture is as high as its distance twice.
SceneDescription pictureScene() {
  SceneDescription s = operationScene();
  s.camera = {};
  s.verticalFieldOfView = 90.0 * degree;
  return s;
}

recorder::AttemptHeader pictureHeader() {
  recorder::AttemptHeader h = operationHeader();
  h.stepResultVersion = 6;
  return h;
}

/// An operation in which each step has a camera of its own.
class Filmed : public Operation {
 public:
  Filmed() : Operation(pictureScene(), pictureHeader()) {
    for (HandResult& hand : now.hand) hand.tipSimulated = Vec3(0.0, 0.0, 0.1);
  }
  void stepWith(const CameraSample& camera) {
    std::vector<TickSamples> samples(10);
    for (TickSamples& tick : samples) tick.camera = camera;
    step(samples);
  }
};

CameraSample rolled(double degrees, const Vec3& lens = Vec3::Zero()) {
  return {lens, Quat(Eigen::AngleAxisd(degrees * degree, Vec3::UnitZ()))};
}

TEST(Camera, FixedOneHasNoFiguresOfItsMotion) {
  Filmed o;
  for (int i = 0; i < 10; ++i) o.stepWith(rolled(0.0));
  o.end();
  for (const char* name : {"camera-horizon", "camera-centring", "camera-path-length"})
    expectNotApplicable(o.value(name), {"camera"});
  EXPECT_DOUBLE_EQ(*o.value("tip-out-of-view", "left").value, 0.0) << "what was out of view is known of any camera";
}

TEST(Camera, HorizonIsTheMeanOfItsDeviations) {
  Filmed o;
  for (int i = 0; i < 10; ++i) o.stepWith(rolled(i < 5 ? 0.0 : i % 2 == 0 ? 8.0 : -4.0));
  o.end();
  EXPECT_NEAR(*o.value("camera-horizon").value / degree, (2 * 8.0 + 3 * 4.0) / 10.0, 1e-9);
}

TEST(Camera, PathIsThatOfTheLens) {
  Filmed o;
  for (int i = 0; i < 11; ++i) o.stepWith(rolled(0.0, Vec3(0.0, 0.0, i % 2 == 0 ? 0.0 : 0.003)));
  o.end();
  EXPECT_NEAR(*o.value("camera-path-length").value, 0.030, 1e-12);
}

TEST(Camera, CentringCountsTheStepsOfTheActiveTip) {
  Filmed o;
  o.stepWith(rolled(0.0));
  for (int i = 0; i < 8; ++i) {
    // The left tip moves at 10 mm/s near the centre, the right one at 20 mm/s beside it in two of eight steps.
    o.now.hand[0].tipSimulated.x() = i % 2 == 0 ? 0.0001 : 0.0;
    o.now.hand[1].tipSimulated = Vec3(0.0, i < 2 && i % 2 == 0 ? 0.0702 : 0.07, 0.1);
    o.stepWith(rolled(1.0));
  }
  o.end();
  // Step 1 jumps to beside the centre and step 2 moves back by 0.2 mm; then the left tip alone is active.
  EXPECT_NEAR(*o.value("camera-centring").value, 6.0 / 8.0, 1e-12);
}

TEST(Camera, CentringGivesCurrentPrecedenceOverSpeed) {
  Filmed o;
  o.stepWith(rolled(0.0));
  o.now.hand[1].instrument = InstrumentKind::hook;
  o.now.hand[1].cautery = Cautery::withoutContact;
  o.now.hand[1].tipSimulated = Vec3(0.0, 0.07, 0.1);
  o.stepWith(rolled(0.0));
  for (int i = 0; i < 3; ++i) {
    o.now.hand[0].tipSimulated.x() += 0.001;
    o.stepWith(rolled(1.0));
  }
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("camera-centring").value, 0.0);
}

TEST(Camera, CentringNeedsAnActiveTip) {
  Filmed o;
  o.stepWith(rolled(0.0));
  o.stepWith(rolled(1.0));
  o.end();
  expectNotApplicable(o.value("camera-centring"), {"tip"});
}

TEST(Camera, TipsOutOfViewAreTimed) {
  Filmed o;
  for (int i = 0; i < 10; ++i) {
    o.now.hand[0].tipSimulated = i < 4 ? Vec3(0.0, -0.11, 0.1) : Vec3(0.0, -0.09, 0.1);
    o.now.hand[1].tipSimulated = i < 7 ? Vec3(0.0, 0.0, -0.1) : Vec3(0.11, 0.0, 0.1);
    o.stepWith(rolled(0.0));
  }
  o.end();
  EXPECT_NEAR(*o.value("tip-out-of-view", "left").value, 0.04, 1e-12);
  EXPECT_NEAR(*o.value("tip-out-of-view", "right").value, 0.07, 1e-12) << "behind the lens";
}

TEST(Camera, AHandWithoutInstrumentIsAbsent) {
  Filmed o;
  o.now.hand[0].instrument = InstrumentKind::none;
  o.stepWith(rolled(0.0));
  o.end();
  EXPECT_EQ(o.value("tip-out-of-view", "left").availability, Availability::absentHand);
}

TEST(Camera, CurrentOnTissueOutOfViewIsTimed) {
  Filmed o;
  o.now.hand[1].instrument = InstrumentKind::hook;
  for (int i = 0; i < 10; ++i) {
    o.now.hand[1].cautery = i < 6 ? Cautery::onTissue : Cautery::withoutContact;
    o.now.hand[1].tipSimulated = i % 2 == 0 ? Vec3(0.115, 0.0, 0.1) : Vec3(0.0, 0.0, 0.1);
    o.stepWith(rolled(0.0));
  }
  o.end();
  EXPECT_NEAR(*o.value("burned-out-of-view").value, 0.03, 1e-12);
}

TEST(Camera, WithoutCurrentOrCutsThereIsNothingToSee) {
  Filmed o;
  o.stepWith(rolled(0.0));
  o.end();
  expectNotApplicable(o.value("burned-out-of-view"), {"current"});
  expectNotApplicable(o.value("cut-out-of-view"), {"clipped"});
}

TEST(Camera, CutsOutOfViewAreCounted) {
  Filmed o;
  const auto tell = [&](EventKind kind, const Vec3& at) {
    o.now.events.push_back({o.next, kind, 1, cysticDuct, at, 0.0});
  };
  tell(EventKind::clipSet, Vec3(0.0, 0.0, 0.1));
  tell(EventKind::vesselCut, Vec3(0.0, 0.12, 0.1));
  o.stepWith(rolled(0.0));
  tell(EventKind::organPerforated, Vec3(0.3, 0.0, 0.1));
  tell(EventKind::graspBegin, Vec3(0.3, 0.0, 0.1));
  o.stepWith(rolled(0.0));
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("cut-out-of-view").value, 2.0);
}

}  // namespace
}  // namespace calot::analytics
