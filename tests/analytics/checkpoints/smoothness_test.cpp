// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/smoothness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>
#include <vector>

namespace calot::analytics::smoothness_test {
namespace {

const double pi = std::acos(-1.0);

/// exp(-5 t^2), t = -1 : 0.01 : 0.99: the example of the reference implementation (SPARC).
std::vector<double> bell() {
  std::vector<double> v;
  for (int i = -100; i < 100; ++i) v.push_back(std::exp(-5.0 * (0.01 * i) * (0.01 * i)));
  return v;
}

/// Speed of a minimum-jerk movement of 1 m in `duration`, at the middles of `points` intervals.
std::vector<double> minimumJerkSpeed(std::size_t points, double duration = 1.0) {
  std::vector<double> v(points);
  for (std::size_t i = 0; i < points; ++i) {
    const double s = (static_cast<double>(i) + 0.5) / static_cast<double>(points);
    v[i] = 30.0 * s * s * (1.0 - s) * (1.0 - s) / duration;
  }
  return v;
}

// SciPy 1.10.1 / NumPy, by the formulas of Balasubramanian et al. 2015.
TEST(Smoothness, publishedVectors) {
  EXPECT_NEAR(*spectralArcLength(bell(), 100.0), -1.414031262, 5e-10);
  EXPECT_NEAR(*dimensionlessJerk(bell(), 100.0), -335.746837, 5e-7);
  EXPECT_NEAR(*logDimensionlessJerk(bell(), 100.0), -5.816357415, 5e-10);
}

TEST(Smoothness, dimensionlessJerkOfAMinimumJerkMovementTendsTo2048) {
  // Integral of v''^2 is 720, the peak 1.875: 720 / 1.875^2 = 204.8. Two values at the ends have no second difference:
  // the error is of first order in dt.
  double before = 1e9;
  for (const std::size_t points : {100U, 1000U, 10000U, 100000U}) {
    const double error = std::abs(*dimensionlessJerk(minimumJerkSpeed(points), static_cast<double>(points)) + 204.8);
    EXPECT_LT(error, before / 5.0) << points;
    before = error;
  }
  EXPECT_LT(before, 0.03);
}

/// A defect of an open tool: smoothness that is the sum of the jerk grows with the duration. These have no unit.
TEST(Smoothness, doesNotDependOnSizeOrDurationOfOneMovement) {
  // LDLJ lacks the jerk of the two ends: an error of the order of dt / T, here 1/400.
  const std::vector<double> quick = minimumJerkSpeed(400, 4.0), slow = minimumJerkSpeed(3200, 32.0);
  EXPECT_NEAR(*logDimensionlessJerk(quick, 100.0), *logDimensionlessJerk(slow, 100.0), 0.03);
  EXPECT_NEAR(*spectralArcLength(quick, 100.0), *spectralArcLength(slow, 100.0), 0.02);
  std::vector<double> large = quick;
  for (double& v : large) v *= 4.0;
  EXPECT_EQ(*dimensionlessJerk(large, 100.0), *dimensionlessJerk(quick, 100.0)) << "powers of two scale exactly";
  EXPECT_EQ(*spectralArcLength(large, 100.0), *spectralArcLength(quick, 100.0));
}

TEST(Smoothness, degenerateSpeedsHaveNone) {
  const std::vector<double> still(300, 0.0), constant(300, 0.2), two{0.1, 0.2};
  EXPECT_FALSE(spectralArcLength(still, 100.0));
  EXPECT_FALSE(dimensionlessJerk(still, 100.0));
  EXPECT_FALSE(dimensionlessJerk(two, 100.0));
  EXPECT_FALSE(logDimensionlessJerk(constant, 100.0)) << "the logarithm of nothing";
  EXPECT_TRUE(spectralArcLength(constant, 100.0));
}

/// Against the plain sum, over random signals of lengths around powers of two.
TEST(Spectrum, isTheDiscreteFourierTransform) {
  const unsigned seed = 20;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (const std::size_t n : {1U, 2U, 3U, 31U, 32U, 33U, 100U, 257U}) {
    std::vector<double> x(n);
    for (double& v : x) v = static_cast<double>(random() % 1000 + 1) / 1000.0;
    for (const int padding : {1, 2, 4}) {
      const Spectrum s = amplitudeSpectrum(x, 100.0, 20.0, padding);
      std::size_t size = 1;
      while (size < n) size *= 2;
      size <<= static_cast<unsigned>(padding);
      ASSERT_DOUBLE_EQ(s.step, 100.0 / static_cast<double>(size));
      ASSERT_EQ(s.magnitude.size(), size / 5 + 1);
      double whole = 0.0;
      for (const double v : x) whole += v;
      for (std::size_t k = 0; k < s.magnitude.size(); ++k) {
        std::complex<double> sum = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
          const double turn = static_cast<double>(i * k % size) / static_cast<double>(size);
          sum += x[i] * std::polar(1.0, -2.0 * pi * turn);
        }
        ASSERT_NEAR(s.magnitude[k], std::abs(sum) / whole, 1e-14)
            << n << " values, padding " << padding << ", bin " << k;
      }
    }
  }
}

}  // namespace
}  // namespace calot::analytics::smoothness_test
