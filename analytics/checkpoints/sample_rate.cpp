// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/sample_rate.h"

#include <cassert>

namespace calot::analytics {
namespace {

constexpr double longest = 0.1;
constexpr double binsPerSecond = 1e5;
constexpr std::size_t binCount = 10001;

}  // namespace

void SampleRate::add(double seconds) {
  assert(seconds > 0.0);
  if (seconds > longest) return;
  if (bins_.empty()) bins_.resize(binCount);
  Bin& bin = bins_[static_cast<std::size_t>(seconds * binsPerSecond + 0.5)];
  ++bin.count;
  bin.seconds += seconds;
  ++count_;
}

double SampleRate::hertz() const {
  if (count_ == 0) return 0.0;
  std::size_t median = 0;
  for (std::uint64_t below = bins_[0].count; 2 * below < count_; below += bins_[median].count) ++median;
  std::uint64_t count = 0;
  double seconds = 0.0;
  for (std::size_t i = 0; i < bins_.size() && 2 * i <= 3 * median; ++i) {
    count += bins_[i].count;
    seconds += bins_[i].seconds;
  }
  return static_cast<double>(count) / seconds;
}

}  // namespace calot::analytics
