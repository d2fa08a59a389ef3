// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/zero_phase_filter.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "sim/math/elementary.h"

namespace calot::analytics {

ZeroPhaseFilter::ZeroPhaseFilter(double cutoff, double rate) {
  assert(cutoff > 0.0 && cutoff < rate / 2.0);
  const double angle = std::numbers::pi * cutoff / rate;
  const double k = sine(angle) / cosine(angle);
  const double root2 = std::sqrt(2.0);
  const double scale = 1.0 / (1.0 + root2 * k + k * k);
  b0_ = k * k * scale;
  b1_ = 2.0 * b0_;
  b2_ = b0_;
  a1_ = 2.0 * (k * k - 1.0) * scale;
  a2_ = (1.0 - root2 * k + k * k) * scale;
}

void ZeroPhaseFilter::pass(std::vector<double>& signal) const {
  // Transposed direct form II; the state in which a constant input passes unchanged, times the first value.
  double z1 = (1.0 - b0_) * signal.front();
  double z2 = (b2_ - a2_) * signal.front();
  for (double& value : signal) {
    const double x = value;
    const double y = b0_ * x + z1;
    z1 = b1_ * x - a1_ * y + z2;
    z2 = b2_ * x - a2_ * y;
    value = y;
  }
}

std::vector<double> ZeroPhaseFilter::apply(std::span<const double> signal) const {
  assert(signal.size() >= shortest);
  const std::size_t margin = std::min(edge, signal.size() - 1);
  std::vector<double> extended;
  extended.reserve(signal.size() + 2 * margin);
  for (std::size_t i = margin; i >= 1; --i) extended.push_back(2.0 * signal.front() - signal[i]);
  extended.insert(extended.end(), signal.begin(), signal.end());
  for (std::size_t i = 1; i <= margin; ++i) extended.push_back(2.0 * signal.back() - signal[signal.size() - 1 - i]);
  pass(extended);
  std::reverse(extended.begin(), extended.end());
  pass(extended);
  std::reverse(extended.begin(), extended.end());
  return {extended.begin() + static_cast<std::ptrdiff_t>(margin), extended.end() - static_cast<std::ptrdiff_t>(margin)};
}

}  // namespace calot::analytics
