// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/instruments/instrument_shape.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/math/random.h"

namespace calot {
namespace {

Vec3 randomVector(Random& random) { return {random.normal(), random.normal(), random.normal()}; }

Quat randomTurn(Random& random) {
  Quat q(random.normal(), random.normal(), random.normal(), random.normal());
  q.normalize();
  return q;
}

TEST(Port, TheShaftPassesThroughThePortAndKeepsItsRoll) {
  SCOPED_TRACE("seed 41");
  Random random(41);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 port = 0.1 * randomVector(random);
    const Vec3 tip = port + 0.1 * randomVector(random);
    if ((tip - port).norm() < minInsertion) continue;
    const Quat hand = randomTurn(random);
    const Pose pose = throughPort(port, tip, hand, Vec3::UnitZ());
    EXPECT_EQ(pose.position, tip) << "a reachable tip is not moved";
    EXPECT_NEAR(pose.orientation.norm(), 1.0, 1e-14);
    const Mat3 r = pose.orientation.toRotationMatrix();
    const Vec3 axis = (tip - port).normalized();
    EXPECT_LT((r.col(2) - axis).norm(), 1e-12) << "z points along the shaft, away from the port";
    // x lies in the plane of the axis and the hand's x, on the hand's side: nothing is turned about the shaft.
    const Vec3 x = hand.toRotationMatrix().col(0);
    EXPECT_NEAR(r.col(0).dot(axis.cross(x)), 0.0, 1e-12);
    EXPECT_GT(r.col(0).dot(x), 0.0);
    // A pose that is possible already is left as it is.
    const Pose again = throughPort(port, tip, pose.orientation, Vec3::UnitZ());
    EXPECT_LT(again.orientation.angularDistance(pose.orientation), 1e-7);
  }
}

TEST(Port, RollAboutTheShaftIsTheHandsOwn) {
  const Vec3 port(0.0, 0.0, 0.1);
  const Vec3 tip(0.0, 0.0, 0.0);
  const Quat start = alongAxis(Vec3(0.0, 0.0, -1.0), Vec3::UnitX());
  for (const double angle : {0.3, 1.5, 2.8, -2.0}) {
    const Quat rolled = start * Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()));
    EXPECT_LT(throughPort(port, tip, rolled, Vec3::UnitZ()).orientation.angularDistance(rolled), 1e-7) << angle;
  }
}

TEST(Port, ATipAtThePortIsHeldInside) {
  const Vec3 port(0.02, -0.01, 0.1);
  const Vec3 previous = Vec3(1.0, -2.0, -2.0) / 3.0;
  const Pose at = throughPort(port, port, Quat::Identity(), previous);
  EXPECT_LT((at.position - (port + minInsertion * previous)).norm(), 1e-15) << "along the previous direction";
  EXPECT_LT((at.orientation * Vec3::UnitZ() - previous).norm(), 1e-12);
  const Vec3 near = port + 0.004 * Vec3::UnitY();
  const Pose pushed = throughPort(port, near, Quat::Identity(), previous);
  EXPECT_LT((pushed.position - (port + minInsertion * Vec3::UnitY())).norm(), 1e-15) << "along its own direction";
  const Vec3 enough = port + minInsertion * Vec3::UnitY();
  EXPECT_LT((throughPort(port, enough, Quat::Identity(), previous).position - enough).norm(), 1e-15);
}

TEST(Port, RollAlongTheAxisTakesAFixedPerpendicular) {
  SCOPED_TRACE("seed 42");
  Random random(42);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 axis = trial < 3 ? Vec3(Vec3::Unit(trial)) : Vec3(randomVector(random).normalized());
    for (const double sign : {1.0, -1.0}) {
      const Quat q = alongAxis(axis, sign * axis);
      ASSERT_TRUE(q.coeffs().allFinite());
      EXPECT_NEAR(q.norm(), 1.0, 1e-14);
      EXPECT_LT((q * Vec3::UnitZ() - axis).norm(), 1e-12);
      EXPECT_EQ(q.coeffs(), alongAxis(axis, -sign * axis).coeffs());
    }
  }
}

/// A pose through a port, with whatever roll.
Pose randomTool(Random& random, const Vec3& port) {
  const Vec3 tip = port + random.uniform(0.02, 0.25) * randomVector(random).normalized();
  return throughPort(port, tip, randomTurn(random), Vec3::UnitZ());
}

/// A point fixed to the tool, by finite differences of the tool's own motion: three ways of the tip and the roll.
TEST(Port, ToolRowIsTheMotionOfAPointOfTheTool) {
  SCOPED_TRACE("seed 43");
  Random random(43);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 port = 0.1 * randomVector(random);
    const Pose tool = randomTool(random, port);
    // On the shaft or up to 15 mm off its axis, as jaws and a hook are.
    const Vec3 local(0.015 * random.normal(), 0.015 * random.normal(), -random.uniform(0.0, 0.1));
    const Vec3 direction = randomVector(random).normalized();
    const ToolRow row = toolRow(port, tool, tool.position + tool.orientation * local, direction);
    constexpr double h = 1e-6;
    for (int k = 0; k < 4; ++k) {
      const auto moved = [&](double by) -> Vec3 {
        const Pose pose = movedTool(port, tool, k < 3 ? Vec3(by * Vec3::Unit(k)) : Vec3::Zero(), k < 3 ? 0.0 : by);
        return pose.position + pose.orientation * local;
      };
      EXPECT_NEAR(row[k], direction.dot(moved(h) - moved(-h)) / (2.0 * h), 2e-7) << "trial " << trial << " part " << k;
    }
  }
  // At the tip nothing is levered and nothing rolls, at the port only motion along the shaft is felt.
  const Pose tool = throughPort(Vec3::Zero(), Vec3(0.0, 0.0, 0.1), Quat::Identity(), Vec3::UnitZ());
  const Vec3 d = Vec3(1.0, 2.0, 2.0) / 3.0;
  EXPECT_LT((toolRow(Vec3::Zero(), tool, tool.position, d) - ToolRow(d[0], d[1], d[2], 0.0)).norm(), 1e-15);
  EXPECT_LT((toolRow(Vec3::Zero(), tool, Vec3::Zero(), d) - ToolRow(0.0, 0.0, d[2], 0.0)).norm(), 1e-15);
}

/// The transpose takes a force to the tip: the work of a small motion is the same by either.
TEST(Port, ToolRowTransposedDoesTheSameWork) {
  SCOPED_TRACE("seed 46");
  Random random(46);
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 port = 0.1 * randomVector(random);
    const Pose tool = randomTool(random, port);
    const Vec3 local(0.01 * random.normal(), 0.01 * random.normal(), -random.uniform(0.0, 0.1));
    const Vec3 point = tool.position + tool.orientation * local;
    const Vec3 force = randomVector(random);
    ToolRow onTip = ToolRow::Zero();
    for (int k = 0; k < 3; ++k) onTip += force[k] * toolRow(port, tool, point, Vec3::Unit(k));
    constexpr double h = 1e-6;
    const Vec3 way = h * randomVector(random);
    const double roll = 10.0 * h * random.normal();
    const Pose after = movedTool(port, tool, way, roll);
    const double work = force.dot(after.position + after.orientation * local - point);
    EXPECT_NEAR(onTip.head<3>().dot(way) + onTip[3] * roll, work, 1e-9 * h / 1e-6);
  }
}

/// Conservative advancement and the reduction to the tip both stand on this: no point of the axis moves farther than
/// the tip.
TEST(Port, NoPointOfTheShaftMovesFartherThanTheTip) {
  SCOPED_TRACE("seed 44");
  Random random(44);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 port = 0.1 * randomVector(random);
    const Pose tool = randomTool(random, port);
    const Vec3 point = port + random.uniform() * (tool.position - port);
    const Vec3 direction = randomVector(random).normalized();
    const ToolRow row = toolRow(port, tool, point, direction);
    EXPECT_LE(row.head<3>().norm(), 1.0 + 1e-12);
    EXPECT_NEAR(row[3], 0.0, 1e-12) << "a roll moves nothing on the axis";
  }
}

TEST(Port, RollBetweenIsWhatMovedToolRolls) {
  SCOPED_TRACE("seed 47");
  Random random(47);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 port = 0.1 * randomVector(random);
    const Pose tool = randomTool(random, port);
    EXPECT_NEAR(rollBetween(tool.orientation, tool.orientation), 0.0, 1e-12);
    const double roll = random.uniform(-3.1, 3.1);
    const Pose rolled = movedTool(port, tool, Vec3::Zero(), roll);
    EXPECT_NEAR(rollBetween(tool.orientation, rolled.orientation), roll, 1e-9);
    EXPECT_LT((rolled.position - tool.position).norm(), 1e-15);
    // A moved tip is where it was sent, the shaft still passes through the port, and nothing has rolled.
    const Vec3 way = 0.004 * randomVector(random);
    const Pose moved = movedTool(port, tool, way, 0.0);
    EXPECT_LT((moved.position - tool.position - way).norm(), 1e-15);
    EXPECT_LT((moved.orientation * Vec3::UnitZ()).cross(moved.position - port).norm(), 1e-12);
    EXPECT_NEAR(rollBetween(tool.orientation, moved.orientation), 0.0, 1e-9);
  }
}

}  // namespace
}  // namespace calot
