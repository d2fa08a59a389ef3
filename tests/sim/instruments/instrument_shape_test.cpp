// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/instruments/instrument_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "sim/math/random.h"
#include "tests/sim/instruments/support/shape_distance.h"

namespace calot {
namespace {

constexpr double shaftRadius = 0.0025;
constexpr double length = 0.15;

std::vector<InstrumentKind> allKinds() {
  std::vector<InstrumentKind> kinds;
  for (const InstrumentDefinition* each : instruments()) kinds.push_back(each->kind);
  return kinds;
}
const std::vector<InstrumentKind> kinds = allKinds();

Vec3 randomNear(Random& random) {
  return {random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), random.uniform(-0.06, 0.02)};
}

TEST(InstrumentShape, NoneHasNoCapsules) {
  const InstrumentShape shape = instrumentShape(InstrumentKind::none, 0.5, shaftRadius, length);
  EXPECT_TRUE(shape.capsules().empty());
  EXPECT_EQ(shape.jawReach(), 0.0);
  EXPECT_EQ(shape.lateralReach(), 0.0);
  EXPECT_GT(test::distanceTo(shape, Vec3::Zero()), 1e100);
}

TEST(InstrumentShape, ReachesFromTheTipToThePort) {
  for (const InstrumentKind kind : kinds) {
    for (const double scale : {1.0, 2.0}) {
      const InstrumentShape shape = instrumentShape(kind, 0.0, scale * shaftRadius, length);
      double front = -1.0;
      double back = 1.0;
      for (const Capsule& c : shape.capsules()) {
        for (const Vec3& p : {c.p0, c.p1}) {
          front = std::max(front, p[2] + c.radius);
          back = std::min(back, p[2]);
        }
        EXPECT_GT(c.radius, 0.0);
        EXPECT_LE(c.radius, scale * shaftRadius);
        if (c.part == Capsule::Part::shaft && c.p1[2] > -length) {
          EXPECT_NEAR(c.p0[2] - c.p1[2], InstrumentShape::pieceLength, 1e-12) << "boxes stay small";
        }
      }
      EXPECT_NEAR(front, 0.0, 1e-4) << "the frame's origin is the tip";
      EXPECT_EQ(back, -length);
    }
  }
  // The whole shaft of a long one is there, in at most maxPieces.
  const InstrumentShape far = instrumentShape(InstrumentKind::grasper, 0.3, shaftRadius, 0.6);
  EXPECT_LT(test::distanceTo(far, Vec3(0.0, 0.0, -0.59)), -0.99 * shaftRadius);
  // One that has hardly entered is its jaws and neck.
  const InstrumentShape shallow = instrumentShape(InstrumentKind::grasper, 0.3, shaftRadius, 0.01);
  for (const Capsule& c : shallow.capsules()) EXPECT_NE(c.part, Capsule::Part::shaft);
}

TEST(InstrumentShape, PiecesKeepTheirNumbers) {
  for (const InstrumentKind kind : kinds) {
    const InstrumentShape a = instrumentShape(kind, 0.0, shaftRadius, 0.1);
    const InstrumentShape b = instrumentShape(kind, 0.9, shaftRadius, 0.2);
    std::set<int> numbers;
    for (const Capsule& c : b.capsules()) numbers.insert(c.piece);
    EXPECT_EQ(numbers.size(), b.capsules().size());
    ASSERT_LE(a.capsules().size(), b.capsules().size());
    for (std::size_t k = 0; k < a.capsules().size(); ++k) {
      EXPECT_EQ(a.capsules()[k].piece, b.capsules()[k].piece);
      EXPECT_EQ(a.capsules()[k].part, b.capsules()[k].part);
    }
  }
}

TEST(InstrumentShape, JawsOpenSymmetricallyAcrossTheHinge) {
  SCOPED_TRACE("seed 321");
  Random random(321);
  for (const InstrumentKind kind : kinds) {
    if (instrumentOf(kind).jawLength == 0.0) continue;
    for (const double jaw : {0.0, 0.4, 1.2}) {
      const InstrumentShape shape = instrumentShape(kind, jaw, shaftRadius, length);
      for (int i = 0; i < 200; ++i) {
        const Vec3 p = randomNear(random);
        EXPECT_NEAR(test::distanceTo(shape, p), test::distanceTo(shape, Vec3(p[0], -p[1], p[2])), 1e-15);
      }
    }
  }
  const double hinge = -0.017;
  const InstrumentShape open = instrumentShape(InstrumentKind::grasper, 1.0, shaftRadius, length);
  EXPECT_GT(test::distanceTo(open, Vec3(0.0, 0.0, -0.004)), 0.003) << "free between open jaws";
  EXPECT_LT(test::distanceTo(open, Vec3(0.0, 0.012 * std::sin(0.5) + 0.0009, hinge + 0.012 * std::cos(0.5))), 0.0);
  const InstrumentShape closed = instrumentShape(InstrumentKind::grasper, 0.0, shaftRadius, length);
  EXPECT_LT(test::distanceTo(closed, Vec3(0.0004, 0.0002, -0.004)), 0.0);
  EXPECT_EQ(test::distanceTo(instrumentShape(InstrumentKind::grasper, -3.0, shaftRadius, length), Vec3(0, 0.01, 0)),
            test::distanceTo(closed, Vec3(0, 0.01, 0)));
}

/// The implicit function is a distance: it changes no faster than its arguments, and what a joint moves is bounded.
TEST(InstrumentShape, MotionsAreBoundedByTheReaches) {
  SCOPED_TRACE("seed 322");
  Random random(322);
  for (const InstrumentKind kind : kinds) {
    double tight = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const double jaw = random.uniform(0.0, 1.5);
      const double change = random.uniform(0.0, 0.3);
      const InstrumentShape a = instrumentShape(kind, jaw, shaftRadius, length);
      const InstrumentShape b = instrumentShape(kind, jaw + change, shaftRadius, length);
      EXPECT_NEAR(a.jawReach(), b.jawReach(), 1e-12) << "rigid about the hinge";
      const Vec3 p = randomNear(random);
      EXPECT_LE(std::abs(test::distanceTo(a, p) - test::distanceTo(b, p)), 0.5 * change * a.jawReach() + 1e-12);
      const double roll = random.uniform(0.0, 0.5);
      const Vec3 turned(p[0] * std::cos(roll) - p[1] * std::sin(roll), p[0] * std::sin(roll) + p[1] * std::cos(roll),
                        p[2]);
      const double moved = std::abs(test::distanceTo(a, p) - test::distanceTo(a, turned));
      EXPECT_LE(moved, roll * std::max(a.lateralReach(), 0.0) + 1e-12);
      tight = std::max(tight, moved / (roll * a.lateralReach() + 1e-9));
      const Vec3 q = randomNear(random);
      EXPECT_LE(std::abs(test::distanceTo(a, p) - test::distanceTo(a, q)), (p - q).norm() * (1.0 + 1e-12));
    }
    if (instrumentOf(kind).action == InstrumentAction::burn) {
      EXPECT_GT(tight, 0.3) << "the toe sweeps round";
    }
  }
}

TEST(InstrumentShape, PlacedInTheWorldIsTheSameShape) {
  SCOPED_TRACE("seed 323");
  Random random(323);
  for (const InstrumentKind kind : kinds) {
    const InstrumentShape shape = instrumentShape(kind, 0.6, shaftRadius, length);
    Pose pose;
    pose.position = Vec3(0.1, -0.2, 0.05);
    pose.orientation = Quat(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
    const InstrumentShape world = placed(shape, pose);
    EXPECT_EQ(world.jawReach(), shape.jawReach());
    for (int i = 0; i < 100; ++i) {
      const Vec3 p = randomNear(random);
      EXPECT_NEAR(test::distanceTo(world, pose.position + pose.orientation * p), test::distanceTo(shape, p), 1e-14);
    }
  }
}

TEST(InstrumentShape, AHookIsAnL) {
  const InstrumentShape shape = instrumentShape(InstrumentKind::hook, 0.7, shaftRadius, length);
  EXPECT_EQ(shape.jawReach(), 0.0);
  EXPECT_LT(test::distanceTo(shape, Vec3(0.0, 0.004, -0.0006)), 0.0) << "the toe";
  EXPECT_GT(test::distanceTo(shape, Vec3(0.0, -0.002, -0.0006)), 0.0) << "on one side alone";
  EXPECT_GT(test::distanceTo(shape, Vec3(0.0, 0.003, -0.004)), 0.0) << "room under it for tissue";
  EXPECT_LT(test::distanceTo(shape, Vec3(0.0, 0.0, -0.006)), 0.0) << "the straight part";
}

TEST(GraspLine, LiesBetweenTheTeeth) {
  for (const double scale : {1.0, 2.0}) {
    const auto [from, to] = graspLine(instrument::grasper, scale * shaftRadius);
    EXPECT_EQ(to, Vec3::Zero()) << "the tips";
    EXPECT_EQ(from.head<2>(), Vec3::Zero().head<2>());
    EXPECT_NEAR(from[2], -0.0136 * scale, 1e-15) << "where the teeth begin";
    const InstrumentShape closed = instrumentShape(InstrumentKind::grasper, 0.0, scale * shaftRadius, length);
    const InstrumentShape open = instrumentShape(InstrumentKind::grasper, 1.0, scale * shaftRadius, length);
    for (const double share : {0.1, 0.5, 1.0}) {
      const Vec3 p = from + share * (to - from);
      EXPECT_LT(std::abs(test::distanceTo(closed, p)), 0.001 * scale) << "at the faces of closed jaws";
      EXPECT_GT(test::distanceTo(open, p), 0.0005 * scale) << "free between open ones";
    }
  }
}

}  // namespace
}  // namespace calot
