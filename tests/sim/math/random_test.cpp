// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

namespace {

using calot::Random;

TEST(RandomTest, GivesThePublishedSequence) {
  // First outputs of the generator's published demonstration program (seed 42, sequence 54; pcg-random.org).
  Random random(42, 54);
  constexpr std::array<std::uint32_t, 6> expected = {0xa15c02b7U, 0x7b47f409U, 0xba1d3330U,
                                                     0x83d2f293U, 0xbfa4784bU, 0xcbed606eU};
  for (const std::uint32_t value : expected) EXPECT_EQ(random.next(), value);
}

TEST(RandomTest, SeedsAndStreamsDiffer) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    for (std::uint64_t stream = 0; stream < 50; ++stream) {
      Random random(seed, stream);
      const std::uint64_t high = random.next();
      seen.insert((high << 32U) | random.next());
    }
  }
  EXPECT_EQ(seen.size(), 2500U);
}

TEST(RandomTest, UniformLiesInItsRangeAndFillsIt) {
  Random random(7);
  constexpr int n = 1000000, bins = 100;
  std::array<int, bins> count{};
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    ASSERT_EQ(u * 9007199254740992.0, std::floor(u * 9007199254740992.0));
    ++count[static_cast<std::size_t>(u * bins)];
    sum += u;
  }
  EXPECT_NEAR(sum / n, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / n));
  double chiSquare = 0.0;
  for (const int c : count) chiSquare += std::pow(c - n / bins, 2) / (n / bins);
  EXPECT_LT(chiSquare, 148.2);  // 99 degrees of freedom, one in a thousand
  EXPECT_GT(chiSquare, 57.0);   // too even is not random either
}

TEST(RandomTest, NormalHasTheMomentsAndTheDistributionOfANormal) {
  Random random(20140611);
  constexpr int n = 400000;
  std::vector<double> values(n);
  double m1 = 0.0, m2 = 0.0, m3 = 0.0, m4 = 0.0;
  for (double& v : values) {
    v = random.normal();
    ASSERT_TRUE(std::isfinite(v));
    m1 += v / n;
    m2 += v * v / n;
    m3 += v * v * v / n;
    m4 += v * v * v * v / n;
  }
  // Five standard errors each: variances of the powers are 1, 2, 15 and 96.
  EXPECT_NEAR(m1, 0.0, 5.0 * std::sqrt(1.0 / n));
  EXPECT_NEAR(m2, 1.0, 5.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(m3, 0.0, 5.0 * std::sqrt(15.0 / n));
  EXPECT_NEAR(m4, 3.0, 5.0 * std::sqrt(96.0 / n));
  // Kolmogorov and Smirnov at one in a thousand.
  std::sort(values.begin(), values.end());
  double distance = 0.0;
  for (int i = 0; i < n; ++i) {
    const double cdf = 0.5 * std::erfc(-values[static_cast<std::size_t>(i)] / std::sqrt(2.0));
    distance = std::max({distance, cdf - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - cdf});
  }
  EXPECT_LT(distance, 1.95 / std::sqrt(static_cast<double>(n)));
}

TEST(RandomTest, NormalIsPinnedToTheBit) {
  Random random(42, 54);
  double sum = 0.0;
  for (int i = 0; i < 1000; ++i) sum += random.normal();
  EXPECT_EQ(sum, -0x1.6a8e20c22be16p+3);
  EXPECT_EQ(random.next(), 0xe5a4d2b1U);
}

}  // namespace
