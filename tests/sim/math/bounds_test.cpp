// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/linear.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

namespace calot {
namespace {

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

/// The very zero that the comparisons of the standard give.
TEST(Bounds, KnowBothZeros) {
  EXPECT_EQ(bits(notNegative(-0.0)), bits(-0.0));
  EXPECT_EQ(bits(notNegative(0.0)), bits(0.0));
  EXPECT_EQ(bits(notPositive(-0.0)), bits(0.0));
  EXPECT_EQ(bits(notPositive(0.0)), bits(0.0));
  EXPECT_EQ(bits(notNegative(Vec3(-0.0, -1.0, 2.0))[0]), bits(-0.0));
  EXPECT_EQ(notNegative(Vec3(-0.0, -1.0, 2.0)), Vec3(0.0, 0.0, 2.0));
}

TEST(Bounds, AreThoseOfTheStandardElsewhere) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  const auto check = [](double x) {
    EXPECT_EQ(bits(notNegative(x)), bits(x < 0.0 ? std::abs(0.0) : x)) << x;
    EXPECT_EQ(bits(notPositive(x)), bits(x < 0.0 ? x : 0.0)) << x;
  };
  for (int i = 0; i < 100'000; ++i) {
    const double x = std::bit_cast<double>(random());
    if (!std::isnan(x)) check(x);
  }
  constexpr double inf = std::numeric_limits<double>::infinity();
  constexpr double tiny = std::numeric_limits<double>::denorm_min();
  for (const double x : {inf, -inf, tiny, -tiny, 1.0, -1.0}) check(x);
}

/// What is no number is held off.
TEST(Bounds, TurnNoNumberIntoZero) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(bits(notNegative(nan)), bits(0.0));
  EXPECT_EQ(bits(notPositive(nan)), bits(0.0));
}

}  // namespace
}  // namespace calot
