// SPDX-License-Identifier: GPL-3.0-or-later
// Closest points between points, segments and triangles: the exact narrow phase. Regions after Ericson, "Real-Time
// Collision Detection" (2005), section 5.1, with degenerate cases (points for segments, slivers for triangles) resolved
// by the minimum over all features. Nothing allocates; everything is inline, since this is the innermost loop of
// contact and of the distance field.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sim/math/linear.h"

namespace calot {

/// Feature of a triangle on which a closest point lies. Edge k joins corner k and corner (k + 1) mod 3.
enum class TriangleFeature : std::uint8_t { face, edge0, edge1, edge2, vertex0, vertex1, vertex2 };

[[nodiscard]] constexpr TriangleFeature edgeFeature(int k) { return static_cast<TriangleFeature>(1 + k); }
[[nodiscard]] constexpr TriangleFeature vertexFeature(int k) { return static_cast<TriangleFeature>(4 + k); }

/// Parameter in [0, 1] of the point of segment a-b closest to p; 0 when a = b.
[[nodiscard]] inline double closestOnSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double length2 = ab.dot(ab);
  if (!(length2 > 0.0)) return 0.0;
  return std::min(notNegative(ab.dot(p - a) / length2), 1.0);
}

struct PointTriangle {
  Vec3 point = Vec3::Zero();        ///< on the triangle (m)
  Vec3 barycentric = Vec3::Zero();  ///< weights of the corners; none negative, sum 1
  double squaredDistance = 0.0;     ///< m^2
  TriangleFeature feature = TriangleFeature::face;
};

namespace detail {

/// Minimum over the three edges, for triangles without a plane.
[[nodiscard]] inline PointTriangle closestOnTriangleEdges(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3* corner[3] = {&a, &b, &c};
  PointTriangle best;
  best.squaredDistance = 1e300;
  for (int k = 0; k < 3; ++k) {
    const Vec3& from = *corner[k];
    const Vec3& to = *corner[(k + 1) % 3];
    const double u = closestOnSegment(p, from, to);
    const Vec3 q = from + u * (to - from);
    const double d2 = (p - q).squaredNorm();
    if (!(d2 < best.squaredDistance)) continue;
    best.point = q;
    best.squaredDistance = d2;
    best.barycentric = Vec3::Zero();
    best.barycentric[k] = 1.0 - u;
    best.barycentric[(k + 1) % 3] = u;
    best.feature = u <= 0.0 ? vertexFeature(k) : (u >= 1.0 ? vertexFeature((k + 1) % 3) : edgeFeature(k));
  }
  return best;
}

}  // namespace detail

/// The point of triangle abc that is closest to p.
[[nodiscard]] inline PointTriangle closestOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  PointTriangle r;
  const auto at = [&r, &p](const Vec3& point, double u, double v, double w, TriangleFeature feature) {
    r.point = point;
    r.barycentric = Vec3(u, v, w);
    r.squaredDistance = (p - point).squaredNorm();
    r.feature = feature;
    return r;
  };
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = p - a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return at(a, 1.0, 0.0, 0.0, TriangleFeature::vertex0);
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return at(b, 0.0, 1.0, 0.0, TriangleFeature::vertex1);
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return at(c, 0.0, 0.0, 1.0, TriangleFeature::vertex2);

  // Twice the area and the three signed sub-areas, each times twice the area, against the normal: signs decide.
  const Vec3 normal = ab.cross(ac);
  const double area2 = normal.squaredNorm();
  // A sliver's normal is noise: relative to its longest side, sine of its angle below 1e-10.
  if (!(area2 > 1e-20 * ab.squaredNorm() * ac.squaredNorm())) return detail::closestOnTriangleEdges(p, a, b, c);
  const double wc = normal.dot(ab.cross(ap));
  const double wb = normal.dot(ap.cross(ac));
  const double wa = normal.dot((c - b).cross(bp));
  if (wa > 0.0 && wb > 0.0 && wc > 0.0) {
    const double sum = wa + wb + wc;
    const double u = wa / sum;
    const double v = wb / sum;
    const double w = wc / sum;
    return at(u * a + v * b + w * c, u, v, w, TriangleFeature::face);
  }
  return detail::closestOnTriangleEdges(p, a, b, c);
}

struct SegmentSegment {
  double s = 0.0;                ///< parameter in [0, 1] on the first segment
  double t = 0.0;                ///< on the second
  Vec3 first = Vec3::Zero();     ///< closest point on the first (m)
  Vec3 second = Vec3::Zero();    ///< on the second
  double squaredDistance = 0.0;  ///< m^2
};

namespace detail {

/// Closest points of lines p0-p1 and q0-q1 strictly inside both segments. @return false: not inside, or parallel (then
/// an end point, which the caller tests, is as close).
[[nodiscard]] inline bool closestInside(const Vec3& p0, const Vec3& p1, const Vec3& q0, const Vec3& q1,
                                        SegmentSegment& r) {
  const Vec3 d = p1 - p0;
  const Vec3 e = q1 - q0;
  const Vec3 w = p0 - q0;
  const Vec3 n = d.cross(e);
  const double denominator = n.squaredNorm();
  if (!(denominator > 1e-24 * d.squaredNorm() * e.squaredNorm())) return false;
  // s and t from cross products: less cancellation than through the Gram determinant.
  const double s = n.dot(e.cross(w)) / denominator;
  const double t = n.dot(d.cross(w)) / denominator;
  if (!(s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0)) return false;
  r.s = s;
  r.t = t;
  r.first = p0 + s * d;
  r.second = q0 + t * e;
  r.squaredDistance = (r.first - r.second).squaredNorm();
  return true;
}

}  // namespace detail

/// Closest points of segments p0-p1 and q0-q1. If many pairs are equally close (parallel segments), the first of: p0,
/// p1 on the second segment, q0, q1 on the first.
[[nodiscard]] inline SegmentSegment closestSegments(const Vec3& p0, const Vec3& p1, const Vec3& q0, const Vec3& q1) {
  SegmentSegment best;
  best.squaredDistance = 1e300;
  const auto offer = [&best](double s, double t, const Vec3& first, const Vec3& second) {
    const double d2 = (first - second).squaredNorm();
    if (!(d2 < best.squaredDistance)) return;
    best = SegmentSegment{s, t, first, second, d2};
  };
  const double t0 = closestOnSegment(p0, q0, q1);
  offer(0.0, t0, p0, q0 + t0 * (q1 - q0));
  const double t1 = closestOnSegment(p1, q0, q1);
  offer(1.0, t1, p1, q0 + t1 * (q1 - q0));
  const double s0 = closestOnSegment(q0, p0, p1);
  offer(s0, 0.0, p0 + s0 * (p1 - p0), q0);
  const double s1 = closestOnSegment(q1, p0, p1);
  offer(s1, 1.0, p0 + s1 * (p1 - p0), q1);
  SegmentSegment inside;
  if (detail::closestInside(p0, p1, q0, q1, inside) && inside.squaredDistance < best.squaredDistance) best = inside;
  return best;
}

struct SegmentTriangle {
  double parameter = 0.0;           ///< in [0, 1] on the segment
  Vec3 onSegment = Vec3::Zero();    ///< m
  Vec3 onTriangle = Vec3::Zero();   ///< m
  Vec3 barycentric = Vec3::Zero();  ///< of onTriangle; none negative, sum 1
  double squaredDistance = 0.0;     ///< m^2; zero when they cross
  TriangleFeature feature = TriangleFeature::face;
  bool crosses = false;  ///< the segment passes through the face; `parameter` says where
};

/// Closest points of segment p0-p1 and triangle abc. The minimum over a crossing, each end against the triangle,
/// each corner against the segment, and the interior of the segment against the interior of each edge; the
/// earlier wins a tie.
[[nodiscard]] inline SegmentTriangle closestSegmentTriangle(const Vec3& p0, const Vec3& p1, const Vec3& a,
                                                            const Vec3& b, const Vec3& c) {
  SegmentTriangle best;
  best.squaredDistance = 1e300;

  const Vec3 normal = (b - a).cross(c - a);
  const double h0 = normal.dot(p0 - a);
  const double h1 = normal.dot(p1 - a);
  if ((h0 < 0.0 && h1 > 0.0) || (h0 > 0.0 && h1 < 0.0)) {
    const double s = h0 / (h0 - h1);
    const Vec3 x = p0 + s * (p1 - p0);
    const double wa = normal.dot((c - b).cross(x - b));
    const double wb = normal.dot((a - c).cross(x - c));
    const double wc = normal.dot((b - a).cross(x - a));
    if (wa >= 0.0 && wb >= 0.0 && wc >= 0.0 && wa + wb + wc > 0.0) {
      best.parameter = s;
      best.onSegment = x;
      best.onTriangle = x;
      best.barycentric = Vec3(wa, wb, wc) / (wa + wb + wc);
      best.squaredDistance = 0.0;
      best.crosses = true;
      return best;
    }
  }

  const auto end = [&best, &a, &b, &c](const Vec3& p, double parameter) {
    const PointTriangle r = closestOnTriangle(p, a, b, c);
    if (!(r.squaredDistance < best.squaredDistance)) return;
    best = SegmentTriangle{parameter, p, r.point, r.barycentric, r.squaredDistance, r.feature, false};
  };
  end(p0, 0.0);
  end(p1, 1.0);

  const Vec3* corner[3] = {&a, &b, &c};
  for (int k = 0; k < 3; ++k) {
    const Vec3& q = *corner[k];
    const double s = closestOnSegment(q, p0, p1);
    const Vec3 x = p0 + s * (p1 - p0);
    const double d2 = (x - q).squaredNorm();
    if (!(d2 < best.squaredDistance)) continue;
    best = SegmentTriangle{s, x, q, Vec3::Unit(k), d2, vertexFeature(k), false};
  }
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    SegmentSegment r;
    if (!detail::closestInside(p0, p1, *corner[k], *corner[next], r)) continue;
    if (!(r.squaredDistance < best.squaredDistance)) continue;
    Vec3 weight = Vec3::Zero();
    weight[k] = 1.0 - r.t;
    weight[next] = r.t;
    best = SegmentTriangle{r.s, r.first, r.second, weight, r.squaredDistance, edgeFeature(k), false};
  }
  return best;
}

}  // namespace calot
