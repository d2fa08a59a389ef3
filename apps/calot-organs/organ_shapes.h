// SPDX-License-Identifier: GPL-3.0-or-later
// Liver and gallbladder of an adult in supine position, in W (docs" "/organs.md): origin in the middle of the
// gallbladder bed, +x to the patient's right, +y anterior, +z cranial (right-handed); metres. Sizes and their sources
// stand in docs/organs.md.
#pragma once

#include "apps/calot-organs/implicit.h"
#include "apps/calot-organs/polygonize.h"

namespace calot::organs {

/// Space between gallbladder and liver along the bed (m): the cystic plate.
inline constexpr double bedGap = 0.0012;

/// Fundus in front, body in the bed, Hartmann's pouch, neck, and the start of the cystic duct, which bends medially and
/// down.
inline double gallbladder(const Vec3& p) {
  static const SweptBall body({{{0.0120, 0.0505, -0.0180}, 0.0121},
                               {{0.0098, 0.0390, -0.0155}, 0.0144},
                               {{0.0060, 0.0200, -0.0118}, 0.0151},
                               {{0.0020, 0.0040, -0.0090}, 0.0130},
                               {{-0.0020, -0.0095, -0.0075}, 0.0106},
                               {{-0.0065, -0.0200, -0.0080}, 0.0076},
                               {{-0.0125, -0.0262, -0.0100}, 0.0047},
                               {{-0.0180, -0.0280, -0.0135}, 0.0034},
                               {{-0.0220, -0.0290, -0.0180}, 0.0028},
                               {{-0.0250, -0.0305, -0.0230}, 0.0026}});
  // The pouch sags from the infundibulum, away from the liver.
  static const SweptBall pouch({{{-0.0005, -0.0105, -0.0115}, 0.0092}, {{-0.0035, -0.0175, -0.0160}, 0.0080}});
  return smoothMin(body(p), pouch(p), 0.008);
}

inline const Box& gallbladderBox() {
  static const Box box{Vec3(-0.040, -0.045, -0.045), Vec3(0.035, 0.072, 0.020)};
  return box;
}

/// Height of the visceral surface over (x, y), before the fossa: rises to the patient's left and to the back.
inline double visceralHeight(double x, double y) {
  double z = 0.004 - 0.37 * x - 0.26 * y;
  const double left = std::max(-x, 0.0);
  z -= 1.3 * left * left;                                              // the left lobe's underside flattens
  z += 0.020 * bump((x + 0.024) / 0.050) * bump((y + 0.038) / 0.050);  // porta hepatis
  z += 0.010 * bump((x - 0.072) / 0.050) * bump((y - 0.004) / 0.055);  // colic and renal impressions
  // Fissure of the round ligament: a notch in the border, shallower towards the porta.
  z += (0.004 + 0.009 * ramp((y - 0.015) / 0.04)) * bump((x + 0.036 + 0.15 * y) / 0.019) * ramp((y + 0.045) / 0.02);
  return z;
}

inline double liver(const Vec3& p) {
  // Leaning back: the front slopes down and forward to the inferior border.
  const Mat3 lean = (Mat3() << 1.0, 0.0, 0.0, 0.0, 0.96, 0.28, 0.0, -0.28, 0.96).finished();
  const double right = ellipsoid(p, {0.047, -0.001, 0.012}, {0.066, 0.055, 0.112}, lean);
  const double middle = ellipsoid(p, {-0.008, 0.000, 0.012}, {0.064, 0.057, 0.077}, lean);
  const double left = ellipsoid(p, {-0.054, 0.014, 0.030}, {0.056, 0.036, 0.036}, lean);
  const double dome = smoothMin(smoothMin(right, middle, 0.030), left, 0.036);
  // The slope's length makes the height difference a distance.
  const double below = (visceralHeight(p[0], p[1]) - p[2]) / 1.1;
  const double body = smoothMax(dome, below, 0.020);
  // Two centimetres off the gallbladder's box the fossa changes nothing.
  const Vec3 outside = (gallbladderBox().lower - p).cwiseMax(p - gallbladderBox().upper);
  return outside.maxCoeff() > 0.02 ? body : smoothMax(body, bedGap - gallbladder(p), 0.006);
}

inline TriangleMesh makeLiver() {
  return polygonize(liver, {Vec3(-0.140, -0.100, -0.090), Vec3(0.140, 0.100, 0.150)}, 0.0066);
}

inline TriangleMesh makeGallbladder() { return polygonize(gallbladder, gallbladderBox(), 0.0032); }

inline constexpr const char* liverHead =
    "Liver of an adult, made by calot-organs from implicit shapes (docs"
    "/organs.md).\n"
    "Metres; +x patient's right, +y anterior, +z cranial; origin in the middle of the gallbladder bed.";
inline constexpr const char* gallbladderHead =
    "Gallbladder of an adult, made by calot-organs from implicit shapes (docs"
    "/organs.md).\n"
    "Metres; +x patient's right, +y anterior, +z cranial; origin in the middle of the gallbladder bed.";

}  // namespace calot::organs
