// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace calot {

/// Inverts a symmetric positive definite matrix in place by Cholesky (Golub and Van Loan 2013, 4.2), in an order that
/// the source fixes. Intended for a few dozen rows.
/// @param a row-major, n * n numbers; only the lower triangle is read; the result is exactly symmetric
/// @return false, with `a` undefined, if it is not positive definite or not finite
bool invertPositive(std::span<double> a, std::size_t n);

}  // namespace calot
