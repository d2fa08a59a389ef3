// SPDX-License-Identifier: GPL-3.0-or-later
// Kernels on whole vectors stored by rows (rowStride numbers each). Internal to this folder.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace calot::sweeps {

/// Lattice nodes at the corners of a row's cell: the ends of four edges.
struct Share {
  static constexpr std::size_t corners = 8;
  std::array<std::uint32_t, corners / 2> edge{};  ///< numbers of edges
  std::array<float, corners> weight{};            ///< of the ends of the first edge, of the second, ...
};

/// A row in which a lattice node has a share.
struct Part {
  std::uint32_t row;  ///< offset in vectors stored by rows
  float weight;
};

/// Rows of R^T in, with R the rotation of each row. @param quaternion of each slice's rows: w, x, y, z,
/// eight lanes each (unit)
/// @param in in lanes
void unrotateRows(const float* quaternion, const float* in, float* out, std::size_t slices);

/// The inverse: R in, in lanes. @param in by rows
void rotateRows(const float* quaternion, const float* in, float* out, std::size_t slices);

/// a . b, in double, in eight sums. @param count number of values, a multiple of eight
double dot(const float* a, const float* b, std::size_t count);

/// out = sum of weight times row. @param out three numbers
void gather(const Part* part, std::size_t count, const float* rows, float* out);

/// out = matrix in. @param matrix `size` rows of `stride` numbers, whole eights @param out by rows of three
void denseTimes(const float* matrix, const float* in, std::size_t size, std::size_t stride, float* out);

/// out = per row the sum of weight times lattice node, by rows. @param edges per edge the rows of both ends
void spread(const Share* share, std::size_t count, const float* edges, float* out);

}  // namespace calot::sweeps
