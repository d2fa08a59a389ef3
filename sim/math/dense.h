// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace calot {

/// Inverts a symmetric positive definite matrix in place by Cholesky (Golub and Van Loan 2013, 4.2), in an order that
/// the source fixes. For a few dozen rows.
/// @param a row-major, n * n numbers; the lower triangle counts, the result is symmetric to the bit
/// @return false, with `a` undefined, where it is not positive definite or not finite
bool invertPositive(std::span<double> a, std::size_t n);

}  // namespace calot
