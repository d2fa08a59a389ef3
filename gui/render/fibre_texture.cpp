// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/fibre_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "gui/render/noise_texture.h"

namespace calot::gui {
namespace {

/// The noise volume between its texels: derivatives and value.
class Noise {
 public:
  std::array<double, 4> operator()(double x, double y, double z) const {
    const std::array<double, 3> p{x, y, z};
    std::array<std::size_t, 3> low{}, high{};
    std::array<double, 3> t{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double texel = p[a] * noiseSide / noiseCells - 0.5;
      const double whole = std::floor(texel);
      t[a] = texel - whole;
      const int at = (static_cast<int>(whole) % noiseSide + noiseSide) % noiseSide;
      low[a] = static_cast<std::size_t>(at);
      high[a] = static_cast<std::size_t>((at + 1) % noiseSide);
    }
    std::array<double, 4> out{};
    for (unsigned corner = 0; corner < 8; ++corner) {
      double weight = 1.0;
      std::array<std::size_t, 3> at{};
      for (std::size_t a = 0; a < 3; ++a) {
        const bool far = ((corner >> a) & 1U) != 0;
        at[a] = far ? high[a] : low[a];
        weight *= far ? t[a] : 1.0 - t[a];
      }
      const std::size_t texel = 4 * ((at[2] * noiseSide + at[1]) * noiseSide + at[0]);
      for (std::size_t c = 0; c < 4; ++c) out[c] += weight * static_cast<double>(volume_[texel + c]);
    }
    return out;
  }

 private:
  std::vector<float> volume_ = makeNoiseVolume();
};

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Fibres along the zero lines of a noise that is stretched along t: all of one width, branching where lines meet.
struct Fibre {
  double cover = 0.0;
  double side = 0.0;  // -1 to 1 across the fibre
};
Fibre fibres(const std::array<double, 4>& n, double width) {
  const double away = n[3] / std::max(std::hypot(n[0], n[1]), 0.35);
  return {1.0 - smoothstep(0.25 * width, width, std::abs(away)), std::clamp(away / width, -1.0, 1.0)};
}

std::uint8_t byteOf(double x) { return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(x, 0.0, 1.0))); }

}  // namespace

std::vector<std::uint8_t> makeFibreTexture() {
  const Noise noise;
  std::vector<std::uint8_t> texture;
  texture.reserve(4 * static_cast<std::size_t>(fibreColumns) * fibreRows);
  for (int row = 0; row < fibreRows; ++row)
    for (int column = 0; column < fibreColumns; ++column) {
      // In cells; multiples of noiseCells over the whole texture, so that it repeats.
      const double s = noiseCells * (column + 0.5) / fibreColumns, t = noiseCells * (row + 0.5) / fibreRows;
      const auto bend = noise(s, t, 0.3), film = noise(2.0 * s, t, 6.2), tone = noise(2.0 * s, t, 4.4);
      const double bent = s + 0.45 * bend[3] + 0.10 * tone[3];
      const Fibre bundle = fibres(noise(2.0 * bent, t, 1.7), 0.14);
      const Fibre middle = fibres(noise(4.0 * s + 1.6 * bend[3] + 0.5 * film[3], t, 2.9), 0.12);
      const Fibre oblique = fibres(noise(3.0 * s + 2.0 * t + 0.8 * bend[3], t, 5.1), 0.07);
      const Fibre fine = fibres(noise(7.0 * s + 1.8 * bend[3] + 0.9 * film[3], 2.0 * t, 3.6), 0.20);
      const double strong = smoothstep(-0.35, 0.35, bend[3] + 0.4 * tone[3]);
      const double cover =
          std::max({bundle.cover * (0.55 + 0.45 * strong), 0.70 * middle.cover * (0.25 + 0.75 * strong),
                    0.55 * oblique.cover, 0.26 * fine.cover});
      const double slope = 0.5 * bundle.side * bundle.cover + 0.3 * middle.side * middle.cover +
                           0.2 * fine.side * fine.cover + 0.25 * film[0];
      const double thickness = 0.5 + 0.75 * film[3] + 0.25 * bend[3];
      texture.insert(texture.end(),
                     {byteOf(cover), byteOf(thickness), byteOf(0.5 + 0.5 * slope), byteOf(0.5 + 0.6 * tone[3])});
    }
  return texture;
}

}  // namespace calot::gui
