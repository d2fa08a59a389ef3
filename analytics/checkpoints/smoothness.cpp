// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/smoothness.h"

#include <algorithm>
#include <cmath>

#include "analytics/checkpoints/spectrum.h"
#include "sim/math/elementary.h"

namespace calot::analytics {
namespace {

double peakOf(std::span<const double> speed) {
  double peak = 0.0;
  for (const double v : speed) peak = std::max(peak, v);
  return peak;
}

}  // namespace

std::optional<double> spectralArcLength(std::span<const double> speed, double rate) {
  if (!(peakOf(speed) > 0.0)) return std::nullopt;
  const Spectrum spectrum = amplitudeSpectrum(speed, rate, sparcHighest, sparcPadding);
  const std::vector<double>& m = spectrum.magnitude;
  std::size_t first = 0, last = m.size() - 1;
  while (m[first] < sparcThreshold) ++first;  // ends at 0: M(0) = 1
  while (m[last] < sparcThreshold) --last;
  if (last == first) return std::nullopt;
  const double df = 1.0 / static_cast<double>(last - first);
  double arc = 0.0;
  for (std::size_t k = first + 1; k <= last; ++k) {
    const double dm = m[k] - m[k - 1];
    arc += std::sqrt(df * df + dm * dm);
  }
  return -arc;
}

std::optional<double> dimensionlessJerk(std::span<const double> speed, double rate) {
  const double peak = peakOf(speed);
  if (speed.size() < 3 || !(peak > 0.0)) return std::nullopt;
  const double dt = 1.0 / rate;
  double sum = 0.0;
  for (std::size_t k = 1; k + 1 < speed.size(); ++k) {
    const double jerk = (speed[k + 1] - 2.0 * speed[k] + speed[k - 1]) / (dt * dt);
    sum += jerk * jerk;
  }
  const double duration = static_cast<double>(speed.size()) * dt;
  return -(duration * duration * duration) / (peak * peak) * sum * dt;
}

std::optional<double> logDimensionlessJerk(std::span<const double> speed, double rate) {
  const std::optional<double> jerk = dimensionlessJerk(speed, rate);
  if (!jerk || !(*jerk < 0.0)) return std::nullopt;
  return -logarithm(-*jerk);
}

}  // namespace calot::analytics
