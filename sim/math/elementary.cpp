// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/elementary.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace calot {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double notANumber = std::numeric_limits<double>::quiet_NaN();

// Constants in parts. Every part but the last has at most 33 bits, so that its product with an integer
// below 2^20 is exact.
constexpr std::array<double, 4> halfPiParts = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2ep-69,
                                               0x1.b839a252049c1p-104};
constexpr std::array<double, 2> ln2Parts = {0x1.62e42fefp-1, 0x1.473de6af278edp-34};
constexpr double halfPiHigh = 0x1.921fb54442d18p+0, halfPiLow = 0x1.1a62633145c07p-54;
constexpr double piHigh = 0x1.921fb54442d18p+1, piLow = 0x1.1a62633145c07p-53;

/// a + b with its rounding error (Knuth): sum + error is exact.
struct TwoSum {
  double sum, error;
  TwoSum(double a, double b) : sum(a + b), error(0.0) {
    const double bThere = sum - a;
    error = (a - (sum - bThere)) + (b - bThere);
  }
};

/// c[0] + x (c[1] + x (c[2] + ...)), from the last coefficient on.
template <std::size_t n>
double horner(const std::array<double, n>& c, double x) {
  double sum = c[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) sum = c[i] + x * sum;
  return sum;
}

/// An angle less a multiple of pi/2: angle = quadrant pi/2 + value + tail (mod 2 pi), |value| <= pi/4 (1 + 2^-20).
struct ReducedAngle {
  double value, tail;
  int quadrant;
};

ReducedAngle reduceAngle(double x) {
  const double n = std::floor(x * 0x1.45f306dc9c883p-1 + 0.5);
  // The first difference is exact (Sterbenz); the rounding errors of the next two are compensated.
  const TwoSum second(x - n * halfPiParts[0], -(n * halfPiParts[1]));
  const TwoSum third(second.sum, -(n * halfPiParts[2]));
  const double tail = (second.error + third.error) - n * halfPiParts[3];
  // The clamp has no effect where the reduction is exact; beyond, it keeps the result within [-1, 1].
  const double value = std::clamp(third.sum + tail, -0.7854, 0.7854);
  return {value, std::clamp((third.sum - value) + tail, -1e-15, 1e-15),
          static_cast<int>(n - 4.0 * std::floor(n / 4.0))};
}

// Taylor coefficients: on |r| <= pi/4 the first omitted term is below 2^-58 of the result.
double sineKernel(double r, double tail) {
  static constexpr std::array<double, 8> c = {
      -1.0 / 6.0,        1.0 / 120.0,        -1.0 / 5040.0,          1.0 / 362880.0,
      -1.0 / 39916800.0, 1.0 / 6227020800.0, -1.0 / 1307674368000.0, 1.0 / 355687428096000.0};
  const double z = r * r;
  return r + (r * (z * horner(c, z)) + tail * (1.0 - 0.5 * z));
}

double cosineKernel(double r, double tail) {
  static constexpr std::array<double, 7> c = {
      1.0 / 24.0,        -1.0 / 720.0,         1.0 / 40320.0,         -1.0 / 3628800.0,
      1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0};
  const double z = r * r;
  const double half = 0.5 * z;
  const double leading = 1.0 - half;
  return leading + (((1.0 - leading) - half) + (z * (z * horner(c, z)) - r * tail));
}

double quadrantSine(const ReducedAngle& a, int quadrant) {
  const double size = (quadrant & 1) == 0 ? sineKernel(a.value, a.tail) : cosineKernel(a.value, a.tail);
  return (quadrant & 2) == 0 ? size : -size;
}

/// 2^k for a normal result, k in [-1022, 1023].
double powerOfTwo(int k) { return std::bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52U); }

// atan(j / 8), j = 0 .. 8, each the sum of two.
struct TablePoint {
  double high, low;
};
constexpr std::array<TablePoint, 9> arctangentTable = {{{0.0, 0.0},
                                                        {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
                                                        {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                                        {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
                                                        {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                                        {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
                                                        {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                                        {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
                                                        {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}}};

/// base + sign (table point + rest), the small parts added first.
double assemble(double baseHigh, double baseLow, double sign, const TablePoint& point, double rest) {
  const TwoSum large(baseHigh, sign * point.high);
  const TwoSum all(large.sum, sign * rest);
  return all.sum + (all.error + (large.error + (baseLow + sign * point.low)));
}

}  // namespace

double sine(double x) {
  if (!(std::abs(x) < infinity)) return notANumber;
  const ReducedAngle a = reduceAngle(x);
  return quadrantSine(a, a.quadrant);
}

double cosine(double x) {
  if (!(std::abs(x) < infinity)) return notANumber;
  const ReducedAngle a = reduceAngle(x);
  return quadrantSine(a, a.quadrant + 1);
}

double exponential(double x) {
  if (x != x) return notANumber;
  if (x < -708.0) return 0.0;
  if (x > 709.7) return infinity;
  static constexpr std::array<double, 12> c = {
      1.0 / 2.0,     1.0 / 6.0,      1.0 / 24.0,      1.0 / 120.0,      1.0 / 720.0,       1.0 / 5040.0,
      1.0 / 40320.0, 1.0 / 362880.0, 1.0 / 3628800.0, 1.0 / 39916800.0, 1.0 / 479001600.0, 1.0 / 6227020800.0};
  const double k = std::floor(x * 0x1.71547652b82fep+0 + 0.5);
  const double high = x - k * ln2Parts[0];  // exact
  const double low = k * ln2Parts[1];
  const double r = high - low;
  const double tail = (high - r) - low;
  const double value = 1.0 + (r + (r * r * horner(c, r) + tail));
  // Twice, because 2^1024 is not a number though half of the result may be.
  const int exponent = static_cast<int>(k);
  return value * powerOfTwo(exponent / 2) * powerOfTwo(exponent - exponent / 2);
}

double logarithm(double x) {
  if (x == 0.0) return -infinity;
  if (!(x > 0.0)) return notANumber;
  if (x == infinity) return infinity;
  int k = 0;
  if (x < 0x1p-1022) {
    x *= 0x1p54;
    k = -54;
  }
  // x = 2^k m with m in [2/3, 4/3]: then log m = 2 artanh(s), s = f / (2 + f), f = m - 1.
  const auto bits = std::bit_cast<std::uint64_t>(x);
  k += static_cast<int>(bits >> 52U) - 1023;
  double m = std::bit_cast<double>((bits & 0xFFFFFFFFFFFFFULL) | 0x3FF0000000000000ULL);
  if (m > 4.0 / 3.0) {
    m *= 0.5;
    k += 1;
  }
  static constexpr std::array<double, 11> c = {2.0 / 3.0,  2.0 / 5.0,  2.0 / 7.0,  2.0 / 9.0,  2.0 / 11.0, 2.0 / 13.0,
                                               2.0 / 15.0, 2.0 / 17.0, 2.0 / 19.0, 2.0 / 21.0, 2.0 / 23.0};
  const double f = m - 1.0;  // exact
  const double s = f / (2.0 + f);
  const double z = s * s;
  // 2 s = f - s f, so that f itself enters without error.
  const double correction = s * (f - z * horner(c, z));
  const auto scale = static_cast<double>(k);
  const TwoSum leading(scale * ln2Parts[0], f);
  return leading.sum - ((correction - scale * ln2Parts[1]) - leading.error);
}

double cubeRoot(double x) { return exponential(logarithm(x) / 3.0); }

double arctangent2(double y, double x) {
  if (x != x || y != y) return notANumber;
  double ax = std::abs(x), ay = std::abs(y);
  if (ax == 0.0 && ay == 0.0) return 0.0;
  double large = std::max(ax, ay), small = std::min(ax, ay);
  if (large == infinity) {
    small = small == infinity ? 1.0 : 0.0;
    large = 1.0;
  } else if (large > 0x1p1000) {
    large *= 0x1p-100;
    small *= 0x1p-100;
  } else if (large < 0x1p-900) {
    large *= 0x1p120;
    small *= 0x1p120;
  }
  // atan(small / large) = atan(c) + atan((small - c large) / (large + c small)), c the nearest eighth; the interval of
  // 0 is slightly wider, since 1/8 would lose half the digits of a small angle to cancellation.
  const double ratio = small / large;
  const double eighths = ratio < 3.0 / 32.0 ? 0.0 : std::floor(ratio * 8.0 + 0.5);
  const double c = eighths * 0.125;
  const double t = (small - c * large) / (large + c * small);
  static constexpr std::array<double, 8> series = {-1.0 / 3.0,  1.0 / 5.0,  -1.0 / 7.0,  1.0 / 9.0,
                                                   -1.0 / 11.0, 1.0 / 13.0, -1.0 / 15.0, 1.0 / 17.0};
  const double z = t * t;
  const double rest = t + t * (z * horner(series, z));
  const TablePoint& point = arctangentTable[static_cast<std::size_t>(eighths)];
  const bool steep = ay > ax, left = x < 0.0;
  double angle = 0.0;
  if (steep) {
    angle = assemble(halfPiHigh, halfPiLow, left ? 1.0 : -1.0, point, rest);
  } else if (left) {
    angle = assemble(piHigh, piLow, -1.0, point, rest);
  } else {
    angle = assemble(0.0, 0.0, 1.0, point, rest);
  }
  return y < 0.0 ? -angle : angle;
}

double arccosine(double x) {
  if (x != x) return notANumber;
  const double clamped = std::clamp(x, -1.0, 1.0);
  // tan(a / 2) = sqrt((1 - x) / (1 + x)): whichever of the two differences is small is exact.
  return 2.0 * arctangent2(std::sqrt(1.0 - clamped), std::sqrt(1.0 + clamped));
}

}  // namespace calot
