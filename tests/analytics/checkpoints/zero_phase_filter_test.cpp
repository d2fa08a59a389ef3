// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace calot::analytics::zero_phase_filter_test {
namespace {

const double pi = std::acos(-1.0);

/// Amplitude and phase of a long sine after the filter, away from the edges.
std::pair<double, double> response(double frequency) {
  const ZeroPhaseFilter filter(6.0, 100.0);
  std::vector<double> x(4000);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sin(2.0 * pi * frequency * static_cast<double>(i) / 100.0);
  const std::vector<double> y = filter.apply(x);
  double in = 0.0, quadrature = 0.0;
  const std::size_t from = 1000, points = 2000;  // whole periods of the frequencies asked for
  for (std::size_t i = from; i < from + points; ++i) {
    const double angle = 2.0 * pi * frequency * static_cast<double>(i) / 100.0;
    in += y[i] * std::sin(angle);
    quadrature += y[i] * std::cos(angle);
  }
  const double a = 2.0 * in / static_cast<double>(points), b = 2.0 * quadrature / static_cast<double>(points);
  return {std::hypot(a, b), std::atan2(b, a)};
}

TEST(ZeroPhaseFilter, hasTheButterworthResponseSquaredAndNoPhase) {
  // |H|^2 of the bilinear transform: 1 / (1 + (tan(pi f / fs) / tan(pi fc / fs))^4), once for each direction's half.
  for (const double f : {0.5, 1.0, 3.0, 4.8, 6.0, 10.0, 20.0}) {
    const double ratio = std::tan(pi * f / 100.0) / std::tan(pi * 6.0 / 100.0);
    const auto [amplitude, phase] = response(f);
    EXPECT_NEAR(amplitude, 1.0 / (1.0 + std::pow(ratio, 4)), 1e-10) << f << " Hz";
    EXPECT_NEAR(phase, 0.0, 1e-8) << f << " Hz";
  }
  EXPECT_NEAR(response(6.0).first, 0.5, 1e-10) << "-6 dB at the cut-off";
}

TEST(ZeroPhaseFilter, passesConstantsAndStraightLines) {
  const ZeroPhaseFilter filter(6.0, 100.0);
  std::vector<double> constant(60, 0.37), line(60);
  for (std::size_t i = 0; i < line.size(); ++i) line[i] = 0.1 + 0.02 * static_cast<double>(i);
  const auto c = filter.apply(constant), l = filter.apply(line);
  ASSERT_EQ(c.size(), 60U);
  for (std::size_t i = 0; i < 60; ++i) {
    EXPECT_NEAR(c[i], 0.37, 1e-15);
    EXPECT_NEAR(l[i], line[i], 1e-6) << "the start-up has died away in the extension";
  }
}

TEST(ZeroPhaseFilter, isLinearAndNearlySymmetricInTime) {
  const ZeroPhaseFilter filter(6.0, 100.0);
  std::vector<double> x(200), scaled(200);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = std::sin(0.01 * static_cast<double>(i * i % 97));
    scaled[i] = 4.0 * x[i];
  }
  const auto y = filter.apply(x), z = filter.apply(scaled);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(z[i], 4.0 * y[i]) << "powers of two scale exactly";
  std::vector<double> reversed(x.rbegin(), x.rend());
  const auto r = filter.apply(reversed);
  for (std::size_t i = 80; i < 120; ++i) EXPECT_NEAR(r[x.size() - 1 - i], y[i], 1e-6);
}

}  // namespace
}  // namespace calot::analytics::zero_phase_filter_test
