// SPDX-License-Identifier: GPL-3.0-or-later
// Two instruments that meet: they stop each other at any speed and step, push each other alike, and one touch is one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "sim/geometry/closest_point.h"
#include "sim/step/placed_instrument.h"
#include "tests/sim/scene/support/loop.h"

namespace calot {
namespace {

/// Shafts through ports 100 mm apart whose tips change sides: seen from the front, an X far above the block.
SceneDescription crossScene(std::uint32_t ticksPerStep) {
  SceneDescription scene = test::blockScene(300, 6);
  scene.name = "crossed shafts";
  scene.ticksPerStep = ticksPerStep;
  scene.hands[0].port = Vec3(-0.05, 0.0, 0.14);
  scene.hands[1].port = Vec3(0.05, 0.0, 0.14);
  scene.hands[0].home = Vec3(0.03, 0.03, 0.05);
  scene.hands[1].home = Vec3(-0.03, -0.03, 0.05);
  return scene;
}

/// The rotation by half a turn about z takes the left hand to the right one.
Vec3 turned(const Vec3& v) { return {-v[0], -v[1], v[2]}; }
Vec3 tipAt(double y) { return {0.03, y, 0.05}; }

PlacedInstrument placedHand(const Model& model, const State& state, std::size_t hand) {
  PlacedInstrument instrument;
  instrument.place(model.scene().hands[hand], state.hand[hand].instrument);
  return instrument;
}

/// Distance of the surfaces by brute force, with the sign of the side: positive while the left shaft is behind (y) the
/// right one, as at the start.
struct Apart {
  double gap = 1e300;
  double side = 0.0;
};
Apart apart(const Model& model, const State& state) {
  const PlacedInstrument a = placedHand(model, state, 0);
  const PlacedInstrument b = placedHand(model, state, 1);
  Apart out;
  for (const Capsule& p : a.capsule) {
    for (const Capsule& q : b.capsule) {
      const SegmentSegment near = closestSegments(p.p0, p.p1, q.p0, q.p1);
      const double gap = std::sqrt(near.squaredDistance) - p.radius - q.radius;
      if (gap < out.gap) out = {gap, near.first[1] - near.second[1]};
    }
  }
  return out;
}

int touchesIn(const StepResult& result) {
  return static_cast<int>(std::count_if(result.events.begin(), result.events.end(),
                                        [](const Event& e) { return e.kind == EventKind::instrumentsTouched; }));
}

TEST(InstrumentClash, ShaftsThatCrossStopEachOtherAtAnySpeedAndStep) {
  for (const std::uint32_t ticks : {1U, 5U, 10U, 20U}) {
    const std::unique_ptr<const Model> model = test::buildModel(crossScene(ticks));
    ASSERT_TRUE(model);
    for (const double speed : {0.03, 0.3, 2.0, 20.0}) {  // of each tip (m/s)
      SCOPED_TRACE(testing::Message() << ticks << " ms, " << speed << " m/s");
      test::Rig rig(*model);
      const double way = speed * model->stepSeconds();
      int touches = 0;
      double deepest = 0.0;
      double y = 0.03;
      for (int still = 0; still < 10;) {
        y = std::max(y - way, -0.03);
        still += y == -0.03 ? 1 : 0;
        const StepResult& result = rig.step(tipAt(y), turned(tipAt(y)));
        touches += touchesIn(result);
        const Apart now = apart(*model, rig.state);
        deepest = std::max(deepest, -now.gap);
        EXPECT_GT(now.side, 0.0) << "the shafts have passed through each other at y = " << y;
      }
      EXPECT_EQ(touches, 1);
      EXPECT_LT(deepest, 3e-5);
    }
  }
}

TEST(InstrumentClash, ForcesAreEqualAndOpposite) {
  for (const std::uint32_t ticks : {2U, 10U, 20U}) {
    const std::unique_ptr<const Model> model = test::buildModel(crossScene(ticks));
    ASSERT_TRUE(model);
    test::Loop loop(*model);
    double y = 0.03;
    double strongest = 0.0;
    const auto sample = [&](double t) {
      y = std::max(0.03 - 0.1 * t, 0.0);
      TickSamples tick = loop.resting();
      tick.hand[0].position = tipAt(y);
      tick.hand[1].position = turned(tipAt(y));
      return tick;
    };
    for (int i = 0; i * static_cast<int>(ticks) < 600; ++i) {
      const StepResult& result = loop.step(sample, [&] {
        // Between steps each hand feels the other as it was; both come nearer alike, but the left one moves first.
        const Vec3 sum = loop.force[0].force - turned(loop.force[1].force);
        EXPECT_LT(sum.norm(), 0.02 * loop.force[0].force.norm() + 0.02);
        strongest = std::max(strongest, loop.force[0].force.norm());
      });
      const Vec3& left = result.hand[0].contactForce;
      const Vec3& right = result.hand[1].contactForce;
      EXPECT_LT((left - turned(right)).norm(), 1e-3 * left.norm() + 1e-6) << "step " << i;
      EXPECT_NEAR(left[1], -right[1], 1e-3 * left.norm() + 1e-6);
    }
    EXPECT_GT(strongest, 0.5) << "the hands must press";
    EXPECT_LE(strongest, model->scene().hands[0].maxForce * (1.0 + 1e-12));
  }
}

/// Both shafts are levers about their ports: the moment about its port of what each tip feels is that of the same force
/// at the same point, turned round.
TEST(InstrumentClash, PushesTheSamePointWhereverThatIs) {
  SceneDescription scene = crossScene(10);
  scene.hands[1].home = Vec3(-0.01, -0.015, 0.08);
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  const StepResult* result = nullptr;
  for (int i = 0; i < 60; ++i) result = &rig.step(tipAt(std::max(0.03 - 0.001 * i, -0.03)));
  ASSERT_TRUE(result->contact.instrumentsTouch);
  std::vector<ClashPoint> points;
  clashPoints(placedHand(*model, rig.state, 0), placedHand(*model, rig.state, 1), 1e-3, points);
  ASSERT_EQ(points.size(), 1U);
  // Torque about the port divided by the lever of the normal gives the force at the point, from either hand.
  std::array<double, 2> force{};
  for (std::size_t h = 0; h < handCount; ++h) {
    const Vec3 lever = rig.state.hand[h].instrument.position - scene.hands[h].port;
    const Vec3 arm = (h == 0 ? points[0].onA : points[0].onB) - scene.hands[h].port;
    const Vec3 moment = arm.cross(points[0].normal);
    force[h] = lever.cross(result->hand[h].contactForce).dot(moment) / moment.squaredNorm();
  }
  EXPECT_GT(force[0], 0.2);
  EXPECT_NEAR(force[0], -force[1], 0.03 * force[0]);
}

TEST(InstrumentClash, AMillimetreApartThereIsNothing) {
  const std::unique_ptr<const Model> model = test::buildModel(crossScene(10));
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  // Halve for the y at which the gap is 1 mm; the sides are symmetric.
  double lower = 0.0;
  double upper = 0.03;
  for (int i = 0; i < 40; ++i) {
    const double y = 0.5 * (lower + upper);
    State state = rig.state;
    for (std::size_t h = 0; h < handCount; ++h) {
      const Pose pose = throughPort(model->scene().hands[h].port, h == 0 ? tipAt(y) : turned(tipAt(y)),
                                    Quat::Identity(), Vec3(0.0, 0.0, -1.0));
      state.hand[h].instrument.position = pose.position;
      state.hand[h].instrument.orientation = pose.orientation;
    }
    (apart(*model, state).gap < 1e-3 ? lower : upper) = y;
  }
  for (int i = 0; i < 100; ++i) {
    const double y = std::max(upper, 0.03 - 0.0005 * i);
    const StepResult& result = rig.step(tipAt(y), turned(tipAt(y)));
    EXPECT_EQ(touchesIn(result), 0);
    EXPECT_FALSE(result.contact.instrumentsTouch);
    EXPECT_EQ(result.hand[0].contactForce.norm(), 0.0);
    EXPECT_EQ(result.hand[1].contactForce.norm(), 0.0);
  }
  EXPECT_NEAR(apart(*model, rig.state).gap, 1e-3, 1e-5) << "and they are where the hands are";
}

TEST(InstrumentClash, OneTouchIsOneEvent) {
  const std::unique_ptr<const Model> model = test::buildModel(crossScene(10));
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  int touches = 0;
  int interrupted = 0;
  bool before = false;
  const auto run = [&](double from, double to, int steps, double jitter) {
    for (int i = 1; i <= steps; ++i) {
      const double y = from + (to - from) * i / steps + (i % 5 < 2 ? jitter : 0.0);
      const StepResult& result = rig.step(tipAt(y), turned(tipAt(y)));
      touches += touchesIn(result);
      interrupted += before && !result.contact.instrumentsTouch ? 1 : 0;
      before = result.contact.instrumentsTouch;
    }
  };
  run(0.03, 0.004, 30, 0.0);
  run(0.004, 0.004, 100, 0.003);  // chatters at 20 Hz
  EXPECT_GT(interrupted, 10) << "the hand must chatter";
  EXPECT_EQ(touches, 1);
  run(0.004, 0.02, 10, 0.0);
  run(0.02, 0.02, 12, 0.0);
  run(0.02, 0.0, 10, 0.0);
  EXPECT_EQ(touches, 2) << "another one after a pause";
}

TEST(InstrumentClash, TakesNoEnergyFromNothing) {
  const std::unique_ptr<const Model> model = test::buildModel(crossScene(10));
  ASSERT_TRUE(model);
  test::Loop loop(*model);
  std::array<test::Felt, handCount> felt;
  const auto sample = [&](double t) {  // presses, rubs along, lets go, four times
    TickSamples tick = loop.resting();
    const double phase = 2.0 * 3.14159265358979 * t;
    const double y = 0.012 + 0.012 * std::cos(phase);
    tick.hand[0].position = tipAt(y) + Vec3(0.004 * std::sin(phase), 0.0, 0.004 * std::sin(2.0 * phase));
    tick.hand[1].position = turned(tipAt(y));
    return tick;
  };
  for (int i = 0; i < 400; ++i) {
    loop.step(sample, [&] {
      for (std::size_t h = 0; h < handCount; ++h) felt[h].take(loop.haptic[h], loop.force[h]);
    });
  }
  EXPECT_GT(felt[0].maxForce, 0.5);
  const double exchanged = felt[0].exchanged + felt[1].exchanged;
  EXPECT_LE(felt[0].work + felt[1].work, 0.02 * exchanged);
  EXPECT_LT(felt[0].maxJump, 0.3);
}

TEST(InstrumentClash, RestoresInMidTouch) {
  const std::unique_ptr<const Model> model = test::buildModel(crossScene(10));
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  const auto step = [](test::Rig& r, int i) {
    const double y = 0.03 - 0.0005 * i;
    return r.step(tipAt(y), turned(tipAt(y))).contact.instrumentsTouch;
  };
  bool touched = false;
  for (int i = 0; i < 55; ++i) touched = step(rig, i);
  ASSERT_TRUE(touched);
  test::Rig other(*model);
  ASSERT_TRUE(restoreState(*model, saveState(rig.state), other.state));
  other.stepper.invalidate();
  for (int i = 55; i < 80; ++i) {
    EXPECT_EQ(step(rig, i), step(other, i));
    ASSERT_EQ(digestOf(rig.state), digestOf(other.state)) << "step " << i;
  }
}

TEST(InstrumentClash, PointsAreTheNearestOnes) {
  const std::unique_ptr<const Model> model = test::buildModel(crossScene(10));
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (int i = 0; i < 40; ++i) {
    rig.step(tipAt(0.03 - 0.0004 * i), turned(tipAt(0.03 - 0.0004 * i)));
    const PlacedInstrument a = placedHand(*model, rig.state, 0);
    const PlacedInstrument b = placedHand(*model, rig.state, 1);
    const double gap = apart(*model, rig.state).gap;
    EXPECT_DOUBLE_EQ(gapBetween(a, b, 1.0), gap);
    EXPECT_DOUBLE_EQ(gapBetween(a, b, 0.5 * gap), 0.5 * gap);
    EXPECT_TRUE(!surelyApart(a, b, 0.01) || gap > 0.01);
    std::vector<ClashPoint> points;
    clashPoints(a, b, gap + 1e-4, points);
    ASSERT_FALSE(points.empty());
    const auto least = std::min_element(points.begin(), points.end(),
                                        [](const ClashPoint& p, const ClashPoint& q) { return p.gap < q.gap; });
    EXPECT_DOUBLE_EQ(least->gap, gap);
    clashPoints(a, b, gap, points);
    EXPECT_TRUE(points.empty());
  }
}

}  // namespace
}  // namespace calot
