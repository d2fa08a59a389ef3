// SPDX-License-Identifier: GPL-3.0-or-later
// Sums of 3x3 blocks between nodes, each rotated with its nodes: compliance between two points of a body.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "sim/math/linear.h"

namespace calot {

/// A matrix by columns, each padded to four numbers.
using RotatedColumns = std::array<double, 12>;
RotatedColumns columnsOf(const Mat3& matrix);

/// sum over i, then j of  A_i B_ij C_j^T, in this order, with the bits of the plain expression of Eigen.
/// @param block B_ij, row-major, at 9 (i nb + j) for nb matrices C; and one number of padding
/// @pre block.size() = 9 na nb + 1
Mat3 sumOfRotated(std::span<const RotatedColumns> a, std::span<const double> block, std::span<const RotatedColumns> c);

}  // namespace calot
