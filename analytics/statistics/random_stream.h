// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <utility>

namespace calot::analytics {

/// Random numbers for resampling and simulation: 64-bit Mersenne Twister, whose bits the C++ standard fixes, with
/// mappings of our own, since the standard library's own differ between libraries. Whoever uses one reports its seed.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in 0 .. n - 1, without the bias of a plain remainder (values below 2^64 mod n are drawn again).
  /// @pre n > 0.
  std::uint64_t below(std::uint64_t n);
  /// Uniform in (0, 1): the middles of 2^52 cells, so that neither end occurs.
  double uniform();
  /// Standard normal, by the quantile of one uniform().
  double normal();

  /// Every order equally likely (Fisher and Yates).
  template <class T>
  void shuffle(std::span<T> items) {
    for (std::size_t i = items.size(); i > 1; --i) {
      const auto j = static_cast<std::size_t>(below(i));
      std::swap(items[i - 1], items[j]);
    }
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace calot::analytics
