// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/haptics/haptic_tick.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr double portFriction = 1.0;   // N
constexpr double wallStiffness = 0.5;  // N m/rad

PortModel aPort() {
  PortModel port;
  port.neutralAxis = Vec3(0.0, 0.0, -1.0);
  port.trocarFriction = portFriction;
  port.wallStiffness = wallStiffness;
  return port;
}

Vec3 tipAt(double length, double tilt, double azimuth) {
  return length * Vec3(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), -std::cos(tilt));
}

/// Work on the hand along a path (J), by the trapezoidal rule, and the forces at its points.
double workAlong(const PortModel& port, const std::vector<Vec3>& path, double& seal) {
  double work = 0.0;
  Vec3 before = portForce(port, path.front(), seal);
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vec3 now = portForce(port, path[i], seal);
    work += 0.5 * (before + now).dot(path[i] - path[i - 1]);
    before = now;
  }
  return work;
}

/// A closed path of tilts up to 60 degrees and strokes of up to 15 cm, from the tip's place at the start and back to
/// it.
std::vector<Vec3> closedPath(int seed, int points) {
  const double a = 1.0 + seed % 3, b = 1.0 + seed % 5;
  std::vector<Vec3> path;
  for (int i = 0; i <= points; ++i) {
    const double t = 2.0 * std::numbers::pi * i / points;
    path.push_back(tipAt(0.12 + 0.05 * std::sin(a * t), 0.5 * (1.0 - std::cos(b * t)), 0.7 * seed + std::sin(t)));
  }
  return path;
}

TEST(PortForce, IsNothingByDefault) {
  double seal = -1.0;
  EXPECT_TRUE(portForce(PortModel(), Vec3(0.01, 0.02, -0.1), seal).isZero(0.0));
  EXPECT_EQ(seal, -1.0);
  const std::unique_ptr<const Model> model = test::buildModel(test::blockScene());
  ASSERT_TRUE(model);
  for (std::size_t h = 0; h < handCount; ++h) EXPECT_FALSE(hapticModel(*model, h).port.felt());
}

/// Along the shaft against the motion, of Coulomb's size once the seal slips; reversed within twice its stretch.
TEST(PortForce, FrictionOpposesMotion) {
  PortModel port = aPort();
  port.wallStiffness = 0.0;
  double seal = -1.0;
  const double maxStretch = portFriction / port.sealStiffness;
  double length = 0.1;
  EXPECT_TRUE(portForce(port, tipAt(length, 0.3, 1.0), seal).isZero(0.0)) << "at first the seal is unstretched";
  for (const double way : {1.0, -1.0, 1.0}) {
    for (int i = 0; i < 100; ++i) {
      length += way * 1e-4;
      const Vec3 tip = tipAt(length, 0.3, 1.0);
      const Vec3 force = portForce(port, tip, seal);
      EXPECT_LT((force - force.dot(tip.normalized()) * tip.normalized()).norm(), 1e-15) << "along the shaft";
      EXPECT_LE(force.norm(), portFriction * (1.0 + 1e-12));
      if (i * 1e-4 > 2.0 * maxStretch) {
        EXPECT_NEAR(force.dot(tip.normalized()), -way * portFriction, 1e-12);
      }
    }
  }
}

/// Sideways motion alone rubs no seal.
TEST(PortForce, TiltingDoesNotSlide) {
  PortModel port = aPort();
  port.wallStiffness = 0.0;
  double seal = -1.0;
  for (int i = 0; i < 100; ++i) EXPECT_LT(portForce(port, tipAt(0.1, 0.01 * i, 0.02 * i), seal).norm(), 1e-11);
}

/// Of a tilt t the torque about the port is k sin t towards the neutral axis, at any depth: k t for small ones.
TEST(PortForce, WallTurnsBack) {
  PortModel port = aPort();
  port.trocarFriction = 0.0;
  double seal = -1.0;
  for (const double length : {0.02, 0.1, 0.2}) {
    for (const double tilt : {0.001, 0.2, 0.8}) {
      const Vec3 tip = tipAt(length, tilt, 2.0);
      const Vec3 torque = tip.cross(portForce(port, tip, seal));
      EXPECT_NEAR(torque.norm(), wallStiffness * std::sin(tilt), 1e-12);
      EXPECT_GT(torque.dot(tip.cross(port.neutralAxis)), 0.0) << "towards the neutral axis";
    }
  }
}

/// The wall's is a potential's force, k (1 - cos tilt): what a path costs comes back. Friction only costs.
TEST(PortForce, GivesNoEnergyOverClosedPaths) {
  for (int seed = 0; seed < 20; ++seed) {
    PortModel wall = aPort();
    wall.trocarFriction = 0.0;
    double seal = -1.0;
    const double coarse = std::abs(workAlong(wall, closedPath(seed, 2000), seal));
    EXPECT_LT(coarse, 1e-5 * wallStiffness) << seed;
    EXPECT_LT(std::abs(workAlong(wall, closedPath(seed, 4000), seal)), 0.3 * coarse + 1e-12)
        << "second order: " << seed;
    const PortModel both = aPort();
    seal = -1.0;
    const double once = workAlong(both, closedPath(seed, 4000), seal);
    const double again = workAlong(both, closedPath(seed, 4000), seal);
    const double stored = 0.5 * portFriction * portFriction / both.sealStiffness;
    EXPECT_LT(once, 0.0) << seed;
    EXPECT_LT(again, stored - 0.1 * portFriction) << "strokes of 0.2 m and more: " << seed;
  }
}

/// Through the tick: added to the force of contact, within the device's bound, with the same contact force beside it.
TEST(PortForce, IsShownWithinTheDevicesBound) {
  ContactSet set;
  set.step = 4;
  set.kind = {BlockKind::unilateral};
  set.limit = {0.0};
  set.direction = {ToolRow(0.0, 0.0, 1.0, 0.0)};
  set.free = {-0.002};
  set.rate = {0.0};
  set.compliance = {2e-3};
  set.lambda = {0.0};
  HapticModel plain;
  HapticModel felt;
  plain.maxForce = felt.maxForce = 2.5;
  felt.port = aPort();
  felt.port.port = Vec3(0.0, 0.0, 0.1);
  HapticState a, b;
  bool bounded = false;
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.01 * i;
    a.tip = b.tip = Vec3(0.08 * std::sin(t), 0.08 * std::sin(1.7 * t), 0.004 * std::sin(2.3 * t));
    const HapticForce without = hapticTick(plain, a, set);
    const HapticForce with = hapticTick(felt, b, set);
    EXPECT_EQ(a.force, b.force) << "contact alone";
    EXPECT_EQ(without.torque, with.torque);
    EXPECT_LE(with.force.norm(), felt.maxForce * (1.0 + 1e-12));
    bounded = bounded || with.force.norm() > felt.maxForce * (1.0 - 1e-12);
  }
  EXPECT_TRUE(bounded);
}

/// A scene's hand: the wall is at rest where the shaft is at the start, friction as deep as it starts.
TEST(PortForce, RestsWhereTheHandStarts) {
  SceneDescription scene = test::blockScene();
  for (HandDescription& hand : scene.hands) {
    hand.trocarFriction = portFriction;
    hand.wallStiffness = wallStiffness;
  }
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  const State state = initialState(*model, 1);
  for (std::size_t h = 0; h < handCount; ++h) {
    HapticState haptic = initialHaptics(state, h);
    const HapticModel haptics = hapticModel(*model, h);
    EXPECT_LT(hapticTick(haptics, haptic, {}).force.norm(), 1e-12);
    const Vec3 before = haptic.tip;
    haptic.tip += Vec3(0.01, 0.0, 0.0);
    const Vec3 force = hapticTick(haptics, haptic, {}).force;
    EXPECT_LT(force.dot(haptic.tip - before), 0.0);
  }
}

}  // namespace
}  // namespace calot
