// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/noise_texture.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "sim/math/linear.h"

namespace calot::gui {
namespace {

// Three independent 32-bit values for a lattice point: "pcg3d" of Jarzynski and Olano, "Hash functions for GPU
// rendering", JCGT 9(3), 2020.
Vec3 latticeGradient(int i, int j, int k) {
  const auto wrap = [](int v) { return static_cast<std::uint32_t>((v + noiseCells) % noiseCells); };
  std::uint32_t x = wrap(i), y = wrap(j), z = wrap(k);
  x = x * 1664525U + 1013904223U;
  y = y * 1664525U + 1013904223U;
  z = z * 1664525U + 1013904223U;
  for (int round = 0; round < 2; ++round) {
    x += y * z;
    y += z * x;
    z += x * y;
    x ^= x >> 16U;
    y ^= y >> 16U;
    z ^= z >> 16U;
  }
  const auto unit = [](std::uint32_t v) { return static_cast<double>(v >> 8U) / 8388608.0 - 1.0; };
  const Vec3 g(unit(x), unit(y), unit(z));
  const double length = g.norm();
  return length > 1e-6 ? Vec3(g * (1.2 / length)) : Vec3(1.2, 0.0, 0.0);
}

double fade(double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }
double fadeSlope(double t) { return 30.0 * t * t * (t * (t - 2.0) + 1.0); }

}  // namespace

std::vector<float> makeNoiseVolume() {
  std::vector<float> volume;
  volume.reserve(4 * static_cast<std::size_t>(noiseSide) * noiseSide * noiseSide);
  constexpr double cellsPerTexel = static_cast<double>(noiseCells) / noiseSide;
  for (int z = 0; z < noiseSide; ++z)
    for (int y = 0; y < noiseSide; ++y)
      for (int x = 0; x < noiseSide; ++x) {
        const Vec3 p = (Vec3(x, y, z).array() + 0.5) * cellsPerTexel;
        const Index3 cell(static_cast<int>(p.x()), static_cast<int>(p.y()), static_cast<int>(p.z()));
        const Vec3 t = p - cell.cast<double>();
        double value = 0.0;
        Vec3 slope = Vec3::Zero();
        for (int corner = 0; corner < 8; ++corner) {
          const Index3 o(corner & 1, (corner >> 1) & 1, corner >> 2);
          const Vec3 g = latticeGradient(cell.x() + o.x(), cell.y() + o.y(), cell.z() + o.z());
          const double dot = g.dot(t - o.cast<double>());
          Vec3 weight, weightSlope;
          for (int a = 0; a < 3; ++a) {
            weight[a] = o[a] == 1 ? fade(t[a]) : 1.0 - fade(t[a]);
            weightSlope[a] = o[a] == 1 ? fadeSlope(t[a]) : -fadeSlope(t[a]);
          }
          const double w = weight.prod();
          value += w * dot;
          slope += w * g;
          slope.x() += weightSlope.x() * weight.y() * weight.z() * dot;
          slope.y() += weight.x() * weightSlope.y() * weight.z() * dot;
          slope.z() += weight.x() * weight.y() * weightSlope.z() * dot;
        }
        for (int a = 0; a < 3; ++a) volume.push_back(static_cast<float>(slope[a]));
        volume.push_back(static_cast<float>(value));
      }
  return volume;
}

}  // namespace calot::gui
