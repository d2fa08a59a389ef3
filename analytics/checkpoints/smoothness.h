// SPDX-License-Identifier: GPL-3.0-or-later
// Smoothness of a movement from its speed. Equations and conventions: S. Balasubramanian, A. Melendez-Calderon,
// A. Roby-Brami, E. Burdet, "On the analysis of movement smoothness", J. NeuroEng. Rehabil. 12:112 (2015).
#pragma once

#include <optional>
#include <span>

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

}  // namespace calot::analytics
