// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace calot::analytics {

/// Lower quantile of Mann-Whitney's U without ties.
struct RankSumQuantile {
  std::size_t u = 0;   ///< least u with P(U <= u) >= p: R's qwilcox(p, nx, ny)
  double below = 0.0;  ///< P(U < u), which is less than p
};

/// Counts w(k; m, n) of the orders of m and n values with U = k, by w(k; m, n) = w(k - n; m - 1, n) + w(k; m, n - 1)
/// (Mann and Whitney 1947): O(nx^2 ny^2) additions of positive numbers, so that the relative error stays below
/// (nx + ny) 2^-53. The quantiles that a thread has asked for are kept: figures of one study have few sizes.
/// @pre nx, ny > 0, 0 < p <= 1/2; nx + ny <= 1,000, beyond which counts overflow.
RankSumQuantile rankSumQuantile(std::size_t nx, std::size_t ny, double p);

}  // namespace calot::analytics
