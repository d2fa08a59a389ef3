// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/sample_rate.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace calot::analytics {
namespace {

constexpr double binsPerSecond = 1e5;
constexpr double evenIntervals = 1.5;  ///< medians
constexpr double evenShare = 0.1;      ///< of the time

std::size_t binOf(double seconds) { return static_cast<std::size_t>(std::floor(seconds * binsPerSecond + 0.5)); }

}  // namespace

void SampleRate::add(double seconds) {
  assert(seconds > 0.0);
  if (seconds > longestInterval) return;
  const std::size_t at = binOf(seconds);
  if (at >= bins_.size()) bins_.resize(at + 1);
  for (Bin* bin : {&bins_[at], &all_}) {
    ++bin->count;
    bin->seconds += seconds;
  }
}

SampleRate::Bin SampleRate::upTo(double longest) const {
  Bin sum;
  const std::size_t end = std::min(bins_.size(), binOf(std::min(longest, longestInterval)) + 1);
  for (std::size_t i = 0; i < end; ++i) {
    sum.count += bins_[i].count;
    sum.seconds += bins_[i].seconds;
  }
  return sum;
}

double SampleRate::interval() const {
  if (all_.count == 0) return 0.0;
  const auto meanOf = [](const Bin& bin) { return bin.seconds / static_cast<double>(bin.count); };
  std::size_t i = 0;
  for (std::uint64_t count = bins_[0].count; 2 * count < all_.count; count += bins_[i].count) ++i;
  const double median = meanOf(bins_[i]);
  if (upTo(evenIntervals * median).seconds >= evenShare * all_.seconds) return median;
  double seconds = 0.0;
  for (i = 0; i + 1 < bins_.size(); ++i) {
    seconds += bins_[i].seconds;
    if (2.0 * seconds >= all_.seconds) break;
  }
  return meanOf(bins_[i]);  // not empty: with it the sum passed one half, or it is the longest
}

double SampleRate::hertz(double longest) const {
  const Bin sum = upTo(longest);
  return sum.count == 0 ? 0.0 : static_cast<double>(sum.count) / sum.seconds;
}

}  // namespace calot::analytics
