// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "sim/contact/sphere_indentation.h"

namespace calot {
namespace {

constexpr double endRadius = 0.0025;
constexpr double modulus = 6000.0;

/// Sneddon's depth for a force, by halving intervals of the radius of contact.
double sneddon(double force) {
  double low = 0.0;
  double high = 40.0;
  const double wanted = force / (modulus * endRadius * endRadius);
  for (int i = 0; i < 200; ++i) {
    const double t = 0.5 * (low + high);
    const double a = std::tanh(t);
    ((1.0 + a * a) * t - a < wanted ? low : high) = t;
  }
  return endRadius * low * std::tanh(low);
}

/// With the flat end's own, it is Sneddon's sphere, but for the flattened apex.
TEST(SphereIndentation, RoundEndIsSneddonsSphereLessAFlatEnd) {
  for (double force = 1e-4; force < 3.0; force *= 1.7) {
    const double flat = force / (2.0 * modulus * endRadius);
    EXPECT_NEAR(roundEnd(force, endRadius, modulus).depth + flat, sneddon(force), 0.001 * endRadius) << force;
  }
  EXPECT_EQ(flatEndSpread(endRadius), 2.0 * endRadius / std::numbers::pi);
  EXPECT_NEAR(spreadCompliance(0.0, flatEndSpread(endRadius), modulus), 1.0 / (2.0 * modulus * endRadius), 1e-12);
}

TEST(SphereIndentation, RisesEverMoreSlowlyAndItsSlopeIsItsDerivative) {
  double last = 1e300;
  for (double force = 0.0; force < 1.0; force = 1.3 * force + 1e-5) {
    const double h = 1e-7 + 1e-5 * force;
    const Indentation at = roundEnd(force, endRadius, modulus);
    const double difference = roundEnd(force + h, endRadius, modulus).depth - at.depth;
    EXPECT_GT(at.slope, 0.0);
    EXPECT_LT(at.slope, last);
    EXPECT_LE(difference, at.slope * h * (1.0 + 1e-6) + 1e-15);
    EXPECT_GE(difference, roundEnd(force + h, endRadius, modulus).slope * h * (1.0 - 1e-6) - 1e-15);
    last = at.slope;
  }
  EXPECT_NEAR(roundEnd(0.0, endRadius, modulus).depth, 0.0, 1e-12);
  EXPECT_LT(roundEnd(1e6, endRadius, modulus).depth, 0.5 * endRadius);
}

}  // namespace
}  // namespace calot
