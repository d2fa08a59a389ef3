// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/pointing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/math/random.h"

namespace calot::recorder {
namespace {

constexpr std::uint64_t seed = 20140517;

Quat randomRotation(Random& random) {
  Quat q(random.normal(), random.normal(), random.normal(), random.normal());
  return q.normalized();
}

Vec3 randomPoint(Random& random) { return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; }

TEST(Pointing, zRunsFromThePortToTheTipAndTheHingeLiesLevel) {
  Random random(seed);
  for (int n = 0; n < 1000; ++n) {
    const Vec3 port = randomPoint(random), tip = randomPoint(random);
    const Quat q = pointing(port, tip);
    EXPECT_NEAR((q * Vec3::UnitZ() - (tip - port).normalized()).norm(), 0.0, 1e-14);
    EXPECT_NEAR(q.norm(), 1.0, 1e-14);
    const bool upright = (tip - port).normalized().cross(Vec3::UnitY()).norm() < 0.02;
    EXPECT_NEAR((q * Vec3::UnitX()).y(), 0.0, upright ? 0.02 : 1e-14);
  }
}

TEST(Pointing, rollTurnsAboutTheShaft) {
  const Vec3 port(0.1, 0.2, 0.0), tip(0.0, 0.0, 0.05);
  const Vec3 z = (tip - port).normalized();
  for (const double roll : {-3.0, -0.7, 0.2, 1.5}) {
    const Vec3 expected = Eigen::AngleAxisd(roll, z) * (pointing(port, tip) * Vec3::UnitX());
    EXPECT_NEAR((pointing(port, tip, roll) * Vec3::UnitX() - expected).norm(), 0.0, 1e-14);
  }
}

TEST(Pointing, isDefinedForAVerticalShaftAndForNone) {
  const Quat down = pointing(Vec3(0, 0.1, 0), Vec3::Zero());
  EXPECT_NEAR((down * Vec3::UnitZ() + Vec3::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_NEAR(pointing(Vec3::Zero(), Vec3::Zero()).norm(), 1.0, 1e-14);
}

TEST(Pointing, alignmentIsTheShortestTurn) {
  Random random(seed);
  for (int n = 0; n < 1000; ++n) {
    const Quat from = randomRotation(random);
    const Vec3 shaft = randomPoint(random).normalized();
    const Quat to = alignedToShaft(from, shaft);
    EXPECT_NEAR((to * Vec3::UnitZ() - shaft).norm(), 0.0, 1e-9);
    // The turn's angle is the angle between the axes, and no turn that brings one onto the other has a smaller one.
    const double angle = from.angularDistance(to);
    EXPECT_NEAR(angle, std::acos(std::clamp((from * Vec3::UnitZ()).dot(shaft), -1.0, 1.0)), 1e-6);
  }
  const Quat opposite = alignedToShaft(Quat::Identity(), -Vec3::UnitZ());
  EXPECT_NEAR((opposite * Vec3::UnitZ() + Vec3::UnitZ()).norm(), 0.0, 1e-15);
  EXPECT_NEAR((opposite * Vec3::UnitX() - Vec3::UnitX()).norm(), 0.0, 1e-15);
}

TEST(Pointing, quaternionOfItsOwnMatrix) {
  Random random(seed);
  for (int n = 0; n < 2000; ++n) {
    Quat q = randomRotation(random);
    if (n % 4 == 1) q = Quat(0.0, q.x(), q.y(), q.z()).normalized();  // half turns: the hard cases
    if (n % 4 == 2) q = Quat(1e-9, 0.0, q.y(), q.z()).normalized();
    const Quat back = quaternionOf(q.toRotationMatrix());
    EXPECT_GE(back.w(), 0.0);
    EXPECT_NEAR(std::abs(back.dot(q)), 1.0, 1e-14);
  }
}

TEST(Pointing, interpolationTakesTheShorterArcAndHitsTheEnds) {
  Random random(seed);
  for (int n = 0; n < 500; ++n) {
    const Quat a = randomRotation(random), b = randomRotation(random);
    EXPECT_NEAR(std::abs(interpolated(a, b, 0.0).dot(a)), 1.0, 1e-14);
    EXPECT_NEAR(std::abs(interpolated(a, b, 1.0).dot(b)), 1.0, 1e-14);
    const Quat middle = interpolated(a, b, 0.5);
    EXPECT_NEAR(a.angularDistance(middle), 0.5 * a.angularDistance(b), 1e-7);
  }
}

TEST(MinimumJerk, isFlashAndHogansPolynomial) {
  EXPECT_EQ(minimumJerk(-0.1), 0.0);
  EXPECT_EQ(minimumJerk(0.0), 0.0);
  EXPECT_EQ(minimumJerk(1.0), 1.0);
  EXPECT_EQ(minimumJerk(7.0), 1.0);
  EXPECT_DOUBLE_EQ(minimumJerk(0.5), 0.5);
  const double h = 1e-5;
  EXPECT_NEAR((minimumJerk(0.5 + h) - minimumJerk(0.5 - h)) / (2 * h), 1.875, 1e-8);
  EXPECT_NEAR(minimumJerk(h) / h, 0.0, 1e-8);
  for (double s = 0.0; s <= 1.0; s += 0.01) EXPECT_NEAR(minimumJerk(s) + minimumJerk(1.0 - s), 1.0, 1e-14);
}

}  // namespace
}  // namespace calot::recorder
