// SPDX-License-Identifier: GPL-3.0-or-later
// Smoothness of a movement from its speed. Equations and conventions: S. Balasubramanian, A. Melendez-Calderon,
// A. Roby-Brami, E. Burdet, "On the analysis of movement smoothness", J. NeuroEng. Rehabil. 12:112 (2015).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace calot::analytics {

/// Spectral arc length: SPARC = -sum sqrt((df / (fc - f0))^2 + dM^2) over the bins from f0 to fc of the amplitude
/// spectrum M of the speed, as a share of its value at 0 Hz; f0 and fc are the first and last bin, at most
/// sparcHighest, with M >= sparcThreshold. The signal is followed by zeros up to 2^(ceil(log2 n) + sparcPadding)
/// values. 1; negative; nearer to 0 is smoother.
inline constexpr double sparcHighest = 10.0;    ///< Hz
inline constexpr double sparcThreshold = 0.05;  ///< of the value at 0 Hz
inline constexpr int sparcPadding = 4;

/// @param speed (m/s), nowhere negative. @param rate (Hz), > 2 sparcHighest.
/// @return nothing where the speed is 0 throughout or its spectrum has one bin.
std::optional<double> spectralArcLength(std::span<const double> speed, double rate);

/// Dimensionless jerk of a speed profile (the variant of the reference above, not that of the vector jerk):
/// DLJ = -T^3 / v_peak^2 sum (v'')^2 dt, v'' the second differences of the speed, (v(k+1) - 2 v(k) + v(k-1)) / dt^2,
/// T = n dt. 1; negative; nearer to 0 is smoother.
/// @return nothing for fewer than 3 values or a speed of 0 throughout.
std::optional<double> dimensionlessJerk(std::span<const double> speed, double rate);

/// LDLJ = -ln |DLJ|. @return nothing where DLJ has no value or is 0 (constant speed).
std::optional<double> logDimensionlessJerk(std::span<const double> speed, double rate);

/// Lower part of the amplitude spectrum of a signal that is not negative, as a share of its value at 0 Hz.
struct Spectrum {
  double step = 0.0;              ///< between bins (Hz)
  std::vector<double> magnitude;  ///< |X(k step)| / |X(0)|; the first is 1
};

/// Discrete Fourier transform of the signal followed by zeros, of length 2^(ceil(log2 n) + padding); bins up to
/// `highest` (Hz), that one included.
///
/// A transform of our own in source-fixed order: the bins k = 2^padding m + r with one r are a transform of length
/// 2^ceil(log2 n) of the signal multiplied by exp(-2 pi i n r / length), so the zeros are never touched; those of the
/// remainders r and 2^padding - r are each other's mirror image. The same bits everywhere. O(2^padding n log n).
/// @pre rate > 0, 0 < highest < rate / 2, 1 <= padding <= 8, no value of the signal is negative, one is positive
Spectrum amplitudeSpectrum(std::span<const double> signal, double rate, double highest, int padding);

}  // namespace calot::analytics
