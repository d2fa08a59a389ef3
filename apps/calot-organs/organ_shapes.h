// SPDX-License-Identifier: GPL-3.0-or-later
// The organs of assets/organs, in W: origin in the middle of the gallbladder
// bed of an adult in supine position, +x to the patient's right, +y anterior, +z cranial (right-handed); metres. Sizes
// and their sources stand in docs/explanation/organs.md.
//
// Organs are implicit shapes: functions of a point, negative inside, roughly a distance near zero. Only + - * / and
// sqrt, so that their files come out the same on every machine. Smooth unions after Quilez, "Smooth minimum" (2013).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/triangle_mesh.h"
#include "sim/math/linear.h"

namespace calot::organs {

inline Vec3 toMicrometre(const Vec3& p) {
  return {std::round(p[0] * 1e6) / 1e6 + 0.0, std::round(p[1] * 1e6) / 1e6 + 0.0, std::round(p[2] * 1e6) / 1e6 + 0.0};
}

/// Minimum rounded over a width k: at most k / 4 below the sharp one.
inline double smoothMin(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - 0.25 * h * h * k;
}

/// Maximum rounded over a width k: at most k / 4 above the sharp one.
inline double smoothMax(double a, double b, double k) { return -smoothMin(-a, -b, k); }

/// A bump of height 1 at 0 and 0 from |x| = 1 on, with a continuous second derivative.
inline double bump(double x) {
  const double h = std::max(1.0 - x * x, 0.0);
  return h * h * h;
}

/// Rises from 0 at x <= 0 to 1 at x >= 1.
inline double ramp(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Ellipsoid with semi-axes r around c, its axes turned by the rows of `axes`.
inline double ellipsoid(const Vec3& p, const Vec3& c, const Vec3& r, const Mat3& axes) {
  const Vec3 q = axes * (p - c);
  const double k0 = q.cwiseQuotient(r).norm();
  const double k1 = q.cwiseQuotient(r.cwiseProduct(r)).norm();
  return k1 > 0.0 ? k0 * (k0 - 1.0) / k1 : -r.minCoeff();
}

/// A ball of changing radius swept along a smooth curve (Catmull-Rom through the knots).
class SweptBall {
 public:
  struct Knot {
    Vec3 centre;
    double radius;
  };

  /// @pre at least two knots
  explicit SweptBall(const std::vector<Knot>& knots) {
    constexpr int pieces = 16;
    const auto knot = [&knots](std::ptrdiff_t i) {
      return knots[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, std::ssize(knots) - 1))];
    };
    for (std::ptrdiff_t i = 0; i + 1 < std::ssize(knots); ++i) {
      for (int s = 0; s < pieces; ++s) {
        const double t = static_cast<double>(s) / pieces;
        const double t2 = t * t;
        const double t3 = t2 * t;
        const std::array<double, 4> w{0.5 * (-t3 + 2.0 * t2 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
                                      0.5 * (-3.0 * t3 + 4.0 * t2 + t), 0.5 * (t3 - t2)};
        Knot k{Vec3::Zero(), 0.0};
        for (std::size_t j = 0; j < 4; ++j) {
          const Knot from = knot(i + static_cast<std::ptrdiff_t>(j) - 1);
          k.centre += w[j] * from.centre;
          k.radius += w[j] * from.radius;
        }
        sample_.push_back(k);
      }
    }
    sample_.push_back(knots.back());
  }

  [[nodiscard]] double operator()(const Vec3& p) const {
    double least = 1e300;
    for (std::size_t i = 0; i + 1 < sample_.size(); ++i) {
      const Knot& a = sample_[i];
      const Knot& b = sample_[i + 1];
      const Vec3 ab = b.centre - a.centre;
      const double t = std::clamp(ab.dot(p - a.centre) / ab.squaredNorm(), 0.0, 1.0);
      const double d = (p - a.centre - t * ab).norm() - (a.radius + t * (b.radius - a.radius));
      least = std::min(least, d);
    }
    return least;
  }

 private:
  std::vector<Knot> sample_;
};

using Implicit = std::function<double(const Vec3&)>;

/// One Newton step along the gradient (central differences over a tenth of a millimetre) towards value 0.
inline Vec3 projected(const Implicit& f, const Vec3& p) {
  constexpr double h = 1e-4;
  Vec3 gradient;
  for (int k = 0; k < 3; ++k) gradient[k] = (f(p + h * Vec3::Unit(k)) - f(p - h * Vec3::Unit(k))) / (2.0 * h);
  const double square = gradient.squaredNorm();
  return square > 1e-6 ? Vec3(p - (f(p) / square) * gradient) : p;
}

/// Closed, outward, manifold surface of {f < 0}: the boundary of an isosurface stuffing (no slivers, no cracks), its
/// vertices spread by Laplacian smoothing and put back onto the surface, coordinates rounded to the micrometre.
/// @param box around the shape. @param cell of the lattice (m)
inline TriangleMesh polygonize(const Implicit& f, const Box& box, double cell) {
  const BccLattice lattice = BccLattice::around(box, cell);
  std::vector<double> value;
  for (std::int64_t p = 0; p < lattice.points(); ++p) value.push_back(f(lattice.position(p)));
  TriangleMesh mesh = boundarySurface(stuff(lattice, value, 0.0));
  for (int round = 0; round < 12; ++round) {
    std::vector<Vec3> sum(mesh.vertex.size(), Vec3::Zero());
    std::vector<double> count(mesh.vertex.size(), 0.0);
    for (const Index3& v : mesh.triangle) {
      for (int k = 0; k < 3; ++k) {
        sum[slot(v[k])] += mesh.vertex[slot(v[(k + 1) % 3])];
        count[slot(v[k])] += 1.0;
      }
    }
    for (std::size_t i = 0; i < mesh.vertex.size(); ++i) {
      mesh.vertex[i] = projected(f, 0.5 * mesh.vertex[i] + 0.5 * (sum[i] / count[i]));
    }
  }
  for (Vec3& p : mesh.vertex) {
    p = projected(f, projected(f, p));
    p = toMicrometre(p);
  }
  return mesh;
}

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

/// Comment that an organ's file begins with.
inline std::string headOf(const std::string& organ) {
  return organ + ", made by calot-organs from implicit shapes (docs" +
         "/organs.md).\nMetres; +x patient's right, +y anterior, +z cranial; origin in the middle of the gallbladder "
         "bed.";
}

}  // namespace calot::organs
