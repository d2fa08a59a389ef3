// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/surface_form.h"

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace calot::gui {
namespace {

/// A number of a directed side, spread over 64 bits (finaliser of MurmurHash3; Appleby).
std::uint64_t hashOf(int from, int to) {
  std::uint64_t h = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(from)) << 32U) |
                    static_cast<std::uint64_t>(static_cast<std::uint32_t>(to));
  h ^= h >> 33U;
  h *= 0xff51afd7ed558ccdULL;
  h ^= h >> 33U;
  h *= 0xc4ceb9fe1a85ec53ULL;
  h ^= h >> 33U;
  return h;
}

/// Bytewise comparison: a spurious difference only costs time.
template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

}  // namespace

bool isClosed(const std::vector<Index3>& triangle) {
  // If every side has an opposite, both sums are equal. If one has none, they agree only with the probability of
  // a 64-bit hash collision.
  std::uint64_t sum = 0;
  for (const Index3& t : triangle)
    for (int k = 0; k < 3; ++k) sum += hashOf(t[k], t[(k + 1) % 3]) - hashOf(t[(k + 1) % 3], t[k]);
  return sum == 0 && !triangle.empty();
}

void SurfaceForm::update(const std::vector<Vec3>& rest, const std::vector<Index3>& triangle) {
  const bool sameTriangles = same(triangle, triangle_);
  if (sameTriangles && same(rest, rest_)) return;
  if (!sameTriangles) closed_ = isClosed(triangle);
  rest_ = rest;
  triangle_ = triangle;
  restNormal_ = vertexNormals(rest, triangle);
}

}  // namespace calot::gui
