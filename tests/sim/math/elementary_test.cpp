// SPDX-License-Identifier: GPL-3.0-or-later
// Error bounds of the elementary functions, measured against the 64-bit mantissa of long double: its own error is below
// 0.002 units in the last place of a double.
#include "sim/math/elementary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace {

constexpr bool haveReference = std::numeric_limits<long double>::digits >= 64;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Distance from the exact value in units in the last place of the exact value's double.
double ulpError(double value, long double exact) {
  int exponent = 0;
  std::frexp(static_cast<double>(exact), &exponent);
  const long double ulp = std::ldexp(1.0L, std::max(exponent - 53, -1074));
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / ulp);
}

/// Largest error met, and where.
struct Worst {
  double error = 0.0, at = 0.0, second = 0.0;
  void see(double e, double x, double y = 0.0) {
    if (!(e <= error)) {
      error = e;
      at = x;
      second = y;
    }
  }
  void expectWithin(double bound) const {
    std::printf("largest error %.4f ulp at %.17g, %.17g\n", error, at, second);
    EXPECT_LE(error, bound) << "at " << at << ", " << second;
  }
};

class Elementary : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!haveReference) GTEST_SKIP() << "long double is no wider than double on this machine: no reference";
    std::printf("seed %u\n", seed);
  }
  double uniform(double lower, double upper) { return std::uniform_real_distribution<double>(lower, upper)(engine); }
  /// Any finite double of either sign, every exponent alike.
  double anyFinite() {
    for (;;) {
      const auto x = std::bit_cast<double>(static_cast<std::uint64_t>(engine()));
      if (std::isfinite(x)) return x;
    }
  }
  static constexpr unsigned seed = 20140611;
  static constexpr int samples = 400000;
  std::mt19937_64 engine{seed};
};

TEST_F(Elementary, SineAndCosineStayWithinTheirBound) {
  Worst sine, cosine;
  const auto look = [&](double x) {
    sine.see(ulpError(calot::sine(x), std::sin(static_cast<long double>(x))), x);
    cosine.see(ulpError(calot::cosine(x), std::cos(static_cast<long double>(x))), x);
  };
  for (int i = 0; i < samples; ++i) {
    look(uniform(-1e5, 1e5));
    look(uniform(-10.0, 10.0));
    look(std::ldexp(uniform(-1.0, 1.0), static_cast<int>(uniform(-1000.0, 17.0))) * 0.76);
  }
  // The doubles next to every multiple of pi/4: where reduction cancels most, and where the kernels meet.
  for (int n = 0; n <= 127323; ++n) {
    const auto x = static_cast<double>(static_cast<long double>(n) * 0.785398163397448309615660845819875721L);
    for (const double y : {std::nextafter(x, -1e9), x, std::nextafter(x, 1e9)}) {
      if (std::abs(y) > 1e5) continue;
      look(y);
      look(-y);
    }
  }
  sine.expectWithin(1.0);
  cosine.expectWithin(1.0);
}

TEST_F(Elementary, SineAndCosineOfAnyArgumentAreNumbersWithinOne) {
  for (int i = 0; i < samples; ++i) {
    const double x = anyFinite();
    ASSERT_LE(std::abs(calot::sine(x)), 1.0) << x;
    ASSERT_LE(std::abs(calot::cosine(x)), 1.0) << x;
  }
  for (const double x : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(std::isnan(calot::sine(x)));
    EXPECT_TRUE(std::isnan(calot::cosine(x)));
  }
}

TEST_F(Elementary, SineIsOddAndCosineEven) {
  for (int i = 0; i < samples; ++i) {
    const double x = uniform(0.0, 1e5);
    ASSERT_EQ(calot::sine(-x), -calot::sine(x)) << x;
    ASSERT_EQ(calot::cosine(-x), calot::cosine(x)) << x;
  }
  EXPECT_EQ(calot::sine(0.0), 0.0);
  EXPECT_EQ(calot::cosine(0.0), 1.0);
}

TEST_F(Elementary, ExponentialStaysWithinItsBound) {
  Worst worst;
  const auto look = [&](double x) {
    worst.see(ulpError(calot::exponential(x), std::exp(static_cast<long double>(x))), x);
  };
  for (int i = 0; i < samples; ++i) {
    look(uniform(-708.0, 709.7));
    look(uniform(-2.0, 2.0));
    look(std::ldexp(uniform(-1.0, 1.0), static_cast<int>(uniform(-1000.0, 9.0))));
  }
  for (int n = -2042; n <= 2046; ++n) {  // odd multiples of ln(2)/2: both ends of the reduced range
    const auto x = static_cast<double>(static_cast<long double>(n) * 0.346573590279972654708616060729088284L);
    for (const double y : {std::nextafter(x, -1e9), x, std::nextafter(x, 1e9)}) {
      if (y >= -708.0 && y <= 709.7) look(y);
    }
  }
  look(-708.0);
  look(709.7);
  worst.expectWithin(1.0);
}

TEST_F(Elementary, ExponentialAtItsEnds) {
  EXPECT_EQ(calot::exponential(0.0), 1.0);
  EXPECT_EQ(calot::exponential(-708.1), 0.0);
  EXPECT_EQ(calot::exponential(-infinity), 0.0);
  EXPECT_EQ(calot::exponential(709.8), infinity);
  EXPECT_EQ(calot::exponential(infinity), infinity);
  EXPECT_TRUE(std::isnan(calot::exponential(std::numeric_limits<double>::quiet_NaN())));
}

TEST_F(Elementary, LogarithmStaysWithinItsBound) {
  Worst worst;
  const auto look = [&](double x) {
    if (x > 0.0) worst.see(ulpError(calot::logarithm(x), std::log(static_cast<long double>(x))), x);
  };
  for (int i = 0; i < samples; ++i) {
    look(std::abs(anyFinite()));
    look(uniform(0.3, 3.0));
    look(1.0 + std::ldexp(uniform(-0.5, 0.5), -static_cast<int>(uniform(0.0, 52.0))));
    look(std::bit_cast<double>(static_cast<std::uint64_t>(engine()) >> 12U));  // subnormal
  }
  for (int k = -1070; k < 1023; ++k) {  // both ends of the reduced range
    const double x = std::ldexp(4.0 / 3.0, k);
    for (const double y : {std::nextafter(x, 0.0), x, std::nextafter(x, infinity), std::ldexp(1.0, k)}) look(y);
  }
  look(std::numeric_limits<double>::max());
  look(std::numeric_limits<double>::denorm_min());
  worst.expectWithin(1.1);
}

TEST_F(Elementary, CubeRootStaysWithinItsBound) {
  double worst = 0.0;
  for (int i = 0; i < samples; ++i) {
    const double x = std::pow(10.0, uniform(-12.0, 12.0));
    const long double exact = std::cbrt(static_cast<long double>(x));
    worst = std::max(worst, static_cast<double>(std::abs(calot::cubeRoot(x) - exact) / exact));
  }
  EXPECT_LT(worst, 2e-15);
  EXPECT_EQ(calot::cubeRoot(0.0), 0.0);
  EXPECT_TRUE(std::isnan(calot::cubeRoot(-1.0)));
}

TEST_F(Elementary, LogarithmAtItsEnds) {
  EXPECT_EQ(calot::logarithm(1.0), 0.0);
  EXPECT_EQ(calot::logarithm(0.0), -infinity);
  EXPECT_EQ(calot::logarithm(-0.0), -infinity);
  EXPECT_EQ(calot::logarithm(infinity), infinity);
  EXPECT_TRUE(std::isnan(calot::logarithm(-1.0)));
  EXPECT_TRUE(std::isnan(calot::logarithm(std::numeric_limits<double>::quiet_NaN())));
}

TEST_F(Elementary, ArctangentStaysWithinItsBound) {
  Worst worst;
  const auto look = [&](double y, double x) {
    const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    worst.see(ulpError(calot::arctangent2(y, x), exact), y, x);
  };
  for (int i = 0; i < samples; ++i) {
    const double y = uniform(-1.0, 1.0), x = uniform(-1.0, 1.0);
    look(y, x);
    look(y * 1e-3, x);
    look(y, x * 1e-3);
    look(std::ldexp(y, static_cast<int>(uniform(-40.0, 40.0))), x);
    look(anyFinite(), anyFinite());
    // Near the places where the table changes its point.
    const double edge = (std::floor(uniform(0.0, 8.0)) + 0.5) / 8.0 * (1.0 + uniform(-4.0, 4.0) * 2.2e-16);
    look(x * edge, x);
    look(x, x * edge);
  }
  worst.expectWithin(2.0);
}

TEST_F(Elementary, ArctangentOnAxesAndAtItsEnds) {
  const double pi = 3.14159265358979323846;
  EXPECT_EQ(calot::arctangent2(0.0, 0.0), 0.0);
  EXPECT_EQ(calot::arctangent2(0.0, 1.0), 0.0);
  EXPECT_EQ(calot::arctangent2(0.0, -1.0), pi);
  EXPECT_EQ(calot::arctangent2(-0.0, -1.0), pi);
  EXPECT_EQ(calot::arctangent2(1.0, 0.0), pi / 2);
  EXPECT_EQ(calot::arctangent2(-1.0, 0.0), -pi / 2);
  EXPECT_EQ(calot::arctangent2(1.0, 1.0), pi / 4);
  EXPECT_EQ(calot::arctangent2(-1.0, -1.0), -3 * pi / 4);
  EXPECT_EQ(calot::arctangent2(infinity, infinity), pi / 4);
  EXPECT_EQ(calot::arctangent2(1.0, infinity), 0.0);
  EXPECT_EQ(calot::arctangent2(1.0, -infinity), pi);
  EXPECT_EQ(calot::arctangent2(-infinity, 1.0), -pi / 2);
  EXPECT_TRUE(std::isnan(calot::arctangent2(std::numeric_limits<double>::quiet_NaN(), 1.0)));
}

TEST_F(Elementary, ArccosineStaysWithinItsBound) {
  Worst worst;
  const auto look = [&](double x) {
    worst.see(ulpError(calot::arccosine(x), std::acos(static_cast<long double>(x))), x);
  };
  for (int i = 0; i < samples; ++i) {
    look(uniform(-1.0, 1.0));
    const double near = std::ldexp(uniform(0.0, 1.0), -static_cast<int>(uniform(0.0, 53.0)));
    look(1.0 - near);
    look(near - 1.0);
    look(near);
    look(-near);
  }
  worst.expectWithin(3.0);
}

TEST_F(Elementary, ArccosineClampsItsArgument) {
  EXPECT_EQ(calot::arccosine(1.0), 0.0);
  EXPECT_EQ(calot::arccosine(1.5), 0.0);
  EXPECT_EQ(calot::arccosine(-1.0), 3.14159265358979323846);
  EXPECT_EQ(calot::arccosine(-infinity), 3.14159265358979323846);
  EXPECT_TRUE(std::isnan(calot::arccosine(std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
