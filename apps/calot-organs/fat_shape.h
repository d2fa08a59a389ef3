// SPDX-License-Identifier: GPL-3.0-or-later
// The fat over Calot's triangle, in W (docs" "/organs.md): a lobulated pad around cystic duct and cystic artery,
// between the gallbladder's neck, the hepatic duct and the underside of the liver.
#pragma once

#include <cstdint>

#include "apps/calot-organs/organ_shapes.h"
#include "apps/calot-organs/vessel_paths.h"

namespace calot::organs {

/// Space between fat and organs (m).
inline constexpr double fatGap = 0.0003;

/// A number in [-0.5, 0.5) that depends on three whole numbers alone (the mixing function of Murmur3, public domain).
inline double scatter(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t salt) {
  auto h = static_cast<std::uint64_t>(x * 73856093) ^ static_cast<std::uint64_t>(y * 19349663) ^
           static_cast<std::uint64_t>(z * 83492791) ^ (salt * 0x9e3779b97f4a7c15ULL);
  h = (h ^ (h >> 33U)) * 0xff51afd7ed558ccdULL;
  h = (h ^ (h >> 33U)) * 0xc4ceb9fe1a85ec53ULL;
  h ^= h >> 33U;
  return static_cast<double>(h >> 11U) / 9007199254740992.0 - 0.5;
}

/// Distance to the nearest of scattered points, rounded where two are as near: the lobules' middles.
inline double lobules(const Vec3& p, double spacing) {
  const Vec3 at = p / spacing;
  double nearest = 10.0 * spacing;
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto x = static_cast<std::int64_t>(std::floor(at[0])) + dx;
        const auto y = static_cast<std::int64_t>(std::floor(at[1])) + dy;
        const auto z = static_cast<std::int64_t>(std::floor(at[2])) + dz;
        const Vec3 middle(static_cast<double>(x) + 0.5 + 0.6 * scatter(x, y, z, 1),
                          static_cast<double>(y) + 0.5 + 0.6 * scatter(x, y, z, 2),
                          static_cast<double>(z) + 0.5 + 0.6 * scatter(x, y, z, 3));
        nearest = smoothMin(nearest, spacing * (at - middle).norm(), 0.3 * spacing);
      }
    }
  }
  return nearest;
}

inline double fat(const Vec3& p) {
  // Around the cystic duct, from the hepatic duct to the gallbladder.
  static const SweptBall duct({{{-0.0435, -0.0416, -0.0298}, 0.0042},
                               {{-0.0355, -0.0370, -0.0292}, 0.0046},
                               {{-0.0290, -0.0324, -0.0270}, 0.0050},
                               {{-0.0240, -0.0302, -0.0212}, 0.0060},
                               {{-0.0205, -0.0292, -0.0165}, 0.0062}});
  // Around the cystic artery, from the right hepatic artery to the neck.
  static const SweptBall artery({{{-0.0375, -0.0440, -0.0090}, 0.0034},
                                 {{-0.0300, -0.0390, -0.0125}, 0.0036},
                                 {{-0.0230, -0.0340, -0.0125}, 0.0038},
                                 {{-0.0180, -0.0302, -0.0110}, 0.0042}});
  // Fat that fills the triangle between them, along the hepatic duct, and up into the corner of gallbladder and liver.
  static const SweptBall window({{{-0.0405, -0.0412, -0.0205}, 0.0040},
                                 {{-0.0345, -0.0378, -0.0205}, 0.0042},
                                 {{-0.0280, -0.0340, -0.0195}, 0.0042}});
  static const SweptBall along({{{-0.0432, -0.0416, -0.0280}, 0.0036}, {{-0.0412, -0.0422, -0.0110}, 0.0032}});
  static const SweptBall tongue({{{-0.0210, -0.0330, -0.0090}, 0.0036},
                                 {{-0.0180, -0.0305, -0.0020}, 0.0038},
                                 {{-0.0145, -0.0250, 0.0045}, 0.0032},
                                 {{-0.0105, -0.0185, 0.0100}, 0.0032},
                                 {{-0.0070, -0.0130, 0.0130}, 0.0038}});
  const double coarse = std::min({duct(p), artery(p), window(p), along(p), tongue(p)});
  if (coarse > 0.008) return coarse - 0.004;  // farther than every lobule reaches
  double pad = smoothMin(smoothMin(duct(p), artery(p), 0.005), smoothMin(window(p), along(p), 0.005), 0.005);
  pad = smoothMin(pad, tongue(p), 0.004);
  constexpr double spacing = 0.0070;
  const double d = std::min(lobules(p, spacing) / spacing, 1.0);
  pad -= 0.0020 * (0.24 - d);  // swells in the middle of a lobule, furrows between them
  return smoothMax(smoothMax(pad, fatGap - gallbladder(p), 0.0020), fatGap - liver(p), 0.0020);
}

inline TriangleMesh makeFat() {
  return polygonize(fat, {Vec3(-0.062, -0.064, -0.050), Vec3(0.004, -0.008, 0.044)}, 0.0018);
}

inline constexpr const char* fatHead =
    "Fat over Calot's triangle, made by calot-organs from implicit shapes (docs"
    "/organs.md).\n"
    "Metres; +x patient's right, +y anterior, +z cranial; origin in the middle of the gallbladder bed.";

}  // namespace calot::organs
