// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/math/fields.h"
#include "sim/math/random.h"

namespace calot {
namespace {

TEST(RoundedToGrid, isOnTheGridAndNoFartherThanHalfACell) {
  Random random(7);
  for (int n = 0; n < 2000; ++n) {
    TickSamples samples;
    InstrumentSample& hand = samples.hand[1];
    hand.position = Vec3(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3));
    hand.orientation = Quat(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
    hand.jaw = random.uniform(0.0, 1.2);
    const TickSamples rounded = roundedToGrid(samples);
    const InstrumentSample& r = rounded.hand[1];
    for (int i = 0; i < 3; ++i) {
      const double cell = r.position[i] * 1048576.0;
      EXPECT_EQ(cell, std::floor(cell));
      EXPECT_LE(std::abs(r.position[i] - hand.position[i]), 0.5 / 1048576.0);
    }
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(r.orientation.coeffs()[i] * 65536.0, std::floor(r.orientation.coeffs()[i] * 65536.0));
      EXPECT_LE(std::abs(r.orientation.coeffs()[i] - hand.orientation.coeffs()[i]), 0.5 / 65536.0);
    }
    EXPECT_LE(std::abs(r.jaw - hand.jaw), 0.5 / 65536.0);
    const TickSamples again = roundedToGrid(rounded);
    EXPECT_EQ(again.hand[1].position, r.position);
    EXPECT_EQ(again.hand[1].orientation.coeffs(), r.orientation.coeffs());
  }
}

TEST(RoundedToGrid, halvesGoAwayFromZeroAndZeroHasNoSign) {
  TickSamples samples;
  samples.hand[0].position = Vec3(0.5, -0.5, -0.25) / 1048576.0;
  samples.hand[0].jaw = 1.5 / 65536.0;
  const TickSamples r = roundedToGrid(samples);
  EXPECT_EQ(r.hand[0].position.x(), 1.0 / 1048576.0);
  EXPECT_EQ(r.hand[0].position.y(), -1.0 / 1048576.0);
  EXPECT_EQ(r.hand[0].position.z(), 0.0);
  EXPECT_FALSE(std::signbit(r.hand[0].position.z()));
  EXPECT_EQ(r.hand[0].jaw, 2.0 / 65536.0);
}

TEST(RoundedToGrid, whatIsNotFiniteIsNoMeasurement) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity}) {
    TickSamples samples;
    samples.hand[0].position.y() = bad;
    samples.hand[1].orientation.x() = bad;
    const TickSamples r = roundedToGrid(samples);
    for (const InstrumentSample& hand : r.hand) {
      EXPECT_FALSE(hand.valid);
      EXPECT_TRUE(hand.position.allFinite());
      EXPECT_TRUE(hand.orientation.coeffs().allFinite());
    }
  }
}

TEST(RoundedToGrid, whatIsHugeIsClamped) {
  TickSamples samples;
  samples.hand[0].position = Vec3(1e300, -1e300, 0.0);
  const TickSamples r = roundedToGrid(samples);
  EXPECT_EQ(r.hand[0].position.x(), 2147483647.0 / 1048576.0);
  EXPECT_EQ(r.hand[0].position.y(), -2147483647.0 / 1048576.0);
}

}  // namespace
}  // namespace calot
