// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/vein_texture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "sim/math/elementary.h"
#include "sim/math/random.h"

namespace calot::gui {
namespace {

constexpr int trunks = 11;
constexpr double step = 1.0;      // texels
constexpr double widest = 4.6;    // radius of a trunk (texels)
constexpr double thinnest = 0.7;  // where a vein ends
constexpr double reach = 11.0;    // from branch to branch, in radii and a fixed part (texels)
constexpr double fixed = 9.0;
constexpr double emerging = 60.0;  // way over which a trunk comes up out of the depth (texels)

/// The end of a vein that still grows.
struct Tip {
  double s = 0.0, t = 0.0;  ///< texels
  double angle = 0.0;       ///< rad, from s
  double bend = 0.0;        ///< rad a step
  double radius = 0.0;      ///< texels
  double left = 0.0;        ///< way to its next branch (texels)
  double gone = 1e9;        ///< since it came up out of the depth (texels)
};

class Canvas {
 public:
  void dot(double s, double t, double radius) {
    const double strength = std::min(1.0, 0.30 + 0.28 * radius);  // a thin vein shows through less
    const int reached = static_cast<int>(radius + 2.0);
    for (int j = -reached; j <= reached; ++j) {
      for (int i = -reached; i <= reached; ++i) {
        const double column = std::floor(s) + i, row = std::floor(t) + j;
        const double away = std::hypot(column + 0.5 - s, row + 0.5 - t);
        const double cover = strength * std::clamp(radius + 0.5 - away, 0.0, 1.0);
        std::uint8_t& texel = texel_[wrapped(row) * veinSide + wrapped(column)];
        texel = std::max(texel, static_cast<std::uint8_t>(std::lround(255.0 * cover)));
      }
    }
  }
  [[nodiscard]] std::vector<std::uint8_t> taken() { return std::move(texel_); }

 private:
  [[nodiscard]] static std::size_t wrapped(double x) {
    return static_cast<std::size_t>((static_cast<int>(x) % veinSide + veinSide) % veinSide);
  }
  std::vector<std::uint8_t> texel_ = std::vector<std::uint8_t>(static_cast<std::size_t>(veinSide) * veinSide, 0);
};

}  // namespace

std::vector<std::uint8_t> makeVeinTexture() {
  Canvas canvas;
  Random random(36, 5);
  const auto wayOf = [&](double radius) { return (fixed + reach * radius) * random.uniform(0.5, 1.4); };
  std::vector<Tip> growing;
  for (int i = 0; i < trunks; ++i) {
    const double up = i % 2 == 0 ? 0.5 * std::numbers::pi : -0.5 * std::numbers::pi;
    growing.push_back({veinSide * (i + random.uniform(0.2, 0.8)) / trunks,
                       veinSide * (i * 4 % trunks + random.uniform()) / trunks, up + random.uniform(-0.3, 0.3), 0.0,
                       widest * random.uniform(0.55, 1.0), 0.0});
    growing.back().left = wayOf(growing.back().radius);
    growing.back().gone = 0.0;
  }
  while (!growing.empty()) {
    Tip tip = growing.back();
    growing.pop_back();
    while (tip.radius > thinnest) {
      canvas.dot(tip.s, tip.t, tip.radius * std::min(1.0, 0.15 + tip.gone / emerging));
      tip.gone += step;
      // It meanders, and more the thinner it is.
      tip.bend = 0.93 * tip.bend + random.uniform(-0.010, 0.010) * (0.5 + 2.2 / tip.radius);
      tip.angle += tip.bend;
      tip.s += step * cosine(tip.angle);
      tip.t += step * sine(tip.angle);
      tip.radius *= 0.9993;
      tip.left -= step;
      if (tip.left > 0.0) continue;
      const double share = random.uniform(0.12, 0.42);  // of the cubes of the radii
      const double side = random.uniform() < 0.5 ? 1.0 : -1.0;
      Tip branch = tip;
      branch.radius = tip.radius * std::cbrt(share);
      branch.angle += side * random.uniform(0.5, 1.0);
      branch.bend = 0.0;
      branch.gone = 1e9;
      branch.left = wayOf(branch.radius);
      growing.push_back(branch);
      tip.radius *= std::cbrt(1.0 - share);
      tip.angle -= side * random.uniform(0.05, 0.35);
      tip.left = wayOf(tip.radius);
    }
  }
  return canvas.taken();
}

}  // namespace calot::gui
