// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/checkpoints/smoothness.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/math/elementary.h"
#include "sim/math/no_fused_pairs.h"  // first

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

namespace {

/// Complex numbers as two arrays, so that plain loops over them are wide.
struct Complex {
  explicit Complex(std::size_t size) : re(size), im(size) {}
  std::vector<double> re, im;
};

/// exp(-2 pi i k / size) for k = 0 .. count - 1.
Complex roots(std::size_t size, std::size_t count, std::size_t stride) {
  Complex w(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(k * stride) / static_cast<double>(size));
    w.re[k] = cosine(angle);
    w.im[k] = -sine(angle);
  }
  return w;
}

/// Transforms of one length, a power of two (decimation in time).
class Transform {
 public:
  explicit Transform(std::size_t length) : length_(length), order_(length), stage_(length) {
    for (std::size_t i = 1, j = 0; i < length; ++i) {
      std::size_t bit = length >> 1U;
      for (; (j & bit) != 0; bit >>= 1U) j ^= bit;
      j ^= bit;
      order_[i] = j;
    }
    // Factors of the stage of half width w stand at w .. 2 w - 1: contiguous for the loop below.
    const Complex w = roots(length, length / 2, 1);
    for (std::size_t half = 1; half < length; half *= 2) {
      for (std::size_t k = 0; k < half; ++k) {
        stage_.re[half + k] = w.re[k * (length / (2 * half))];
        stage_.im[half + k] = w.im[k * (length / (2 * half))];
      }
    }
  }

  /// Index of the signal's value i in the input of run().
  [[nodiscard]] std::size_t placeOf(std::size_t i) const { return order_[i]; }

  void run(Complex& x) const {
    for (std::size_t half = 1; half < length_; half *= 2) {
      const double* const wr = &stage_.re[half];
      const double* const wi = &stage_.im[half];
      for (std::size_t base = 0; base < length_; base += 2 * half) {
        double* const ar = &x.re[base];
        double* const ai = &x.im[base];
        double* const br = ar + half;
        double* const bi = ai + half;
        for (std::size_t k = 0; k < half; ++k) {
          const double tr = wr[k] * br[k] - wi[k] * bi[k];
          const double ti = wr[k] * bi[k] + wi[k] * br[k];
          br[k] = ar[k] - tr;
          bi[k] = ai[k] - ti;
          ar[k] += tr;
          ai[k] += ti;
        }
      }
    }
  }

 private:
  std::size_t length_;
  std::vector<std::size_t> order_;
  Complex stage_;
};

/// exp(-2 pi i j / size) for any j < size, as a product of two tables.
class Turn {
 public:
  explicit Turn(std::size_t size) {
    while ((std::size_t{1} << (2 * bits_)) < size) ++bits_;
    low_ = roots(size, std::size_t{1} << bits_, 1);
    high_ = roots(size, (size >> bits_) + 1, std::size_t{1} << bits_);
  }
  [[nodiscard]] std::pair<double, double> of(std::size_t j) const {
    const std::size_t h = j >> bits_, l = j & ((std::size_t{1} << bits_) - 1);
    return {high_.re[h] * low_.re[l] - high_.im[h] * low_.im[l], high_.re[h] * low_.im[l] + high_.im[h] * low_.re[l]};
  }

 private:
  unsigned bits_ = 0;
  Complex low_{0}, high_{0};
};

}  // namespace

Spectrum amplitudeSpectrum(std::span<const double> signal, double rate, double highest, int padding) {
  assert(!signal.empty() && rate > 0.0 && highest > 0.0 && highest < rate / 2.0 && padding >= 1 && padding <= 8);
  std::size_t length = 1;
  while (length < signal.size()) length *= 2;
  const std::size_t remainders = std::size_t{1} << static_cast<unsigned>(padding), size = length * remainders;
  Spectrum spectrum;
  spectrum.step = rate / static_cast<double>(size);
  std::size_t bins = 0;
  while (static_cast<double>(bins) * spectrum.step <= highest) ++bins;
  spectrum.magnitude.resize(bins);

  const Transform transform(length);
  const Turn turn(size);
  Complex x(length);
  for (std::size_t r = 0; r <= remainders / 2; ++r) {
    std::fill(x.re.begin(), x.re.end(), 0.0);
    std::fill(x.im.begin(), x.im.end(), 0.0);
    for (std::size_t n = 0; n < signal.size(); ++n) {
      const auto [re, im] = turn.of((n * r) % size);
      const std::size_t at = transform.placeOf(n);
      x.re[at] = signal[n] * re;
      x.im[at] = signal[n] * im;
    }
    transform.run(x);
    const auto magnitude = [&](std::size_t m) { return std::sqrt(x.re[m] * x.re[m] + x.im[m] * x.im[m]); };
    for (std::size_t m = 0; remainders * m + r < bins; ++m) spectrum.magnitude[remainders * m + r] = magnitude(m);
    if (r == 0 || r == remainders / 2) continue;
    // X(-j) is the conjugate of X(j), and -j = remainders (length - 1 - m) + (remainders - r) for j = remainders m + r.
    for (std::size_t m = 0; remainders * m + remainders - r < bins; ++m)
      spectrum.magnitude[remainders * m + remainders - r] = magnitude(length - 1 - m);
  }
  const double whole = spectrum.magnitude.front();
  assert(whole > 0.0);
  for (double& m : spectrum.magnitude) m /= whole;
  return spectrum;
}

}  // namespace calot::analytics
