// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace calot {

/// PCG32 (XSH-RR 64/32; O'Neill 2014, "PCG: a family of simple fast space-efficient statistically good algorithms for
/// random number generation"). Two words of state and the same sequence everywhere. Part of State where the simulation
/// draws random numbers; also used by performers.
struct Random {
  std::uint64_t state = 0;
  std::uint64_t increment = 1;

  Random() = default;
  /// @param seed position in the sequence. @param stream one of 2^63 disjoint sequences
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : increment((stream << 1U) | 1U) {
    next();
    state += seed;
    next();
  }

  /// The next 32 uniform bits.
  std::uint32_t next() {
    const std::uint64_t old = state;
    state = old * 6364136223846793005ULL + increment;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto rotation = static_cast<std::uint32_t>(old >> 59U);
    return (shifted >> rotation) | (shifted << ((32U - rotation) & 31U));
  }

  /// Uniform in [0, 1), on multiples of 2^-53.
  double uniform() {
    const std::uint64_t high = next() >> 5U;
    const std::uint64_t low = next() >> 6U;
    return (static_cast<double>(high) * 67108864.0 + static_cast<double>(low)) * (1.0 / 9007199254740992.0);
  }

  double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }

  /// Standard normal by Marsaglia's polar method; draws until accepted and discards the second value.
  double normal();
};

}  // namespace calot
