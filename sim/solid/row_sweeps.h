// SPDX-License-Identifier: GPL-3.0-or-later
// Kernels on whole vectors by rows (rowStride numbers a row). Internal to this folder.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace calot::sweeps {

/// Of a row: the lattice nodes at the corners of its cell, which are the ends of four edges.
struct Share {
  static constexpr std::size_t corners = 8;
  std::array<std::uint32_t, corners / 2> edge{};  ///< numbers of edges
  std::array<float, corners> weight{};            ///< of the ends of the first edge, of the second, ...
};

/// Of a lattice node: a row that it has a share in.
struct Part {
  std::uint32_t row;  ///< where it begins in vectors by rows
  float weight;
};

/// Rows of R^T in, R of each row. @param quaternion of each slice's rows: w, x, y, z, eight lanes each (unit)
/// @param in in lanes
void turnRows(const float* quaternion, const float* in, float* out, std::size_t slices);

/// The same back: R in, in lanes. @param in by rows
void turnRowsBack(const float* quaternion, const float* in, float* out, std::size_t slices);

/// a . b, in double, in eight sums. @param count of numbers, whole eights
double dot(const float* a, const float* b, std::size_t count);

/// out = sum of weight times row. @param out three numbers
void gather(const Part* part, std::size_t count, const float* rows, float* out);

/// out = matrix in. @param matrix `size` rows of `stride` numbers, whole eights @param out by rows of three
void denseTimes(const float* matrix, const float* in, std::size_t size, std::size_t stride, float* out);

/// out = per row the sum of weight times lattice node, by rows. @param edges of each the rows of both ends
void spread(const Share* share, std::size_t count, const float* edges, float* out);

}  // namespace calot::sweeps
