// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"
//
#include "sim/carving/field_sample.h"

#include <algorithm>
#include <array>

#include "sim/carving/carved_surface.h"
#include "sim/math/bounds.h"

namespace calot {

FieldSample sampleField(const CarvedField& field, const Vec3& p) {
  const BrickLattice& lattice = field.lattice();
  std::array<std::array<std::uint32_t, 2>, 3> offset{};
  std::array<double, 3> t{};
  for (int a = 0; a < 3; ++a) {
    const int last = lattice.nodes()[a] - 1;
    const double x = std::min(notNegative(p[a]), static_cast<double>(last));
    const int i = std::min(static_cast<int>(x), last - 1);
    t[slot(a)] = x - static_cast<double>(i);
    for (int k = 0; k < 2; ++k) {
      Index3 n = Index3::Zero();
      n[a] = i + k;
      offset[slot(a)][slot(k)] = lattice.node(n);
    }
  }
  std::array<double, 8> v{};
  for (std::size_t c = 0; c < 8; ++c) {
    v[c] = field.value(offset[0][c & 1U] + offset[1][c >> 1U & 1U] + offset[2][c >> 2U]);
  }
  const auto mix = [](double a, double b, double s) { return a + s * (b - a); };
  const double x00 = mix(v[0], v[1], t[0]);
  const double x10 = mix(v[2], v[3], t[0]);
  const double x01 = mix(v[4], v[5], t[0]);
  const double x11 = mix(v[6], v[7], t[0]);
  const double y0 = mix(x00, x10, t[1]);
  const double y1 = mix(x01, x11, t[1]);
  FieldSample sample;
  sample.value = mix(y0, y1, t[2]);
  sample.gradient[0] = mix(mix(v[1] - v[0], v[3] - v[2], t[1]), mix(v[5] - v[4], v[7] - v[6], t[1]), t[2]);
  sample.gradient[1] = mix(x10 - x00, x11 - x01, t[2]);
  sample.gradient[2] = y1 - y0;
  return sample;
}

Vec3 gradientAtVertex(const CarvedField& field, std::uint32_t vertex) {
  const BrickLattice& lattice = field.lattice();
  const std::uint32_t node = vertex / 3;
  const int axis = static_cast<int>(vertex % 3);
  const std::uint32_t end = lattice.next(node, axis);
  const double t = surface_vertex::cut(field, vertex);
  // One end is inside, so at most one coordinate of either, along the edge, can lie on the border.
  const Index3 at = lattice.nodeAt(node);
  Vec3 gradient;
  for (int a = 0; a < 3; ++a) {
    if (a == axis) {
      gradient[a] = field.value(end) - field.value(node);
      continue;
    }
    const bool low = at[a] == 0;
    const bool high = at[a] + 1 >= lattice.nodes()[a];
    const auto along = [&](std::uint32_t n) {
      const double before = field.value(low ? n : lattice.previous(n, a));
      const double after = field.value(high ? n : lattice.next(n, a));
      return 0.5 * (after - before);
    };
    const double first = along(node);
    gradient[a] = first + t * (along(end) - first);
  }
  return gradient;
}

}  // namespace calot
