// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace calot::analytics {

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
