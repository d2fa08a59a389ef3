// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/triangle_lanes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sim/contact/broad_phase.h"
#include "sim/math/vectors.h"

namespace calot {

namespace {

/// One lane's vector. Every function below is the scalar one of closest_point.h without branches, its operations in the
/// same order (a dot product is x + (y + z)), so that a compiler can run a loop over lanes as vectors.
struct V {
  double x, y, z;
};
CALOT_INLINE V operator-(const V& a, const V& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
CALOT_INLINE V operator+(const V& a, const V& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
CALOT_INLINE V operator*(double s, const V& a) { return {s * a.x, s * a.y, s * a.z}; }
CALOT_INLINE double dot(const V& a, const V& b) { return a.x * b.x + (a.y * b.y + a.z * b.z); }
CALOT_INLINE double square(const V& a) { return dot(a, a); }
CALOT_INLINE V cross(const V& a, const V& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
CALOT_INLINE double minimum(double a, double b) { return a < b ? a : b; }

/// Squared distance of p from segment a-b.
CALOT_INLINE double fromSegment(const V& p, const V& a, const V& b) {
  const V ab = b - a;
  const double length2 = dot(ab, ab);
  const double u = dot(ab, p - a) / length2;
  const double low = u >= 0.0 ? u : 0.0;  // linear.h
  const double clamped = low > 1.0 ? 1.0 : low;
  const double used = length2 > 0.0 ? clamped : 0.0;
  return square(p - (a + used * ab));
}

/// Squared distance of p from triangle abc.
CALOT_INLINE double fromTriangle(const V& p, const V& a, const V& b, const V& c) {
  const V ab = b - a;
  const V ac = c - a;
  const V ap = p - a;
  const V bp = p - b;
  const V cp = p - c;
  const double d1 = dot(ab, ap);
  const double d2 = dot(ac, ap);
  const double d3 = dot(ab, bp);
  const double d4 = dot(ac, bp);
  const double d5 = dot(ab, cp);
  const double d6 = dot(ac, cp);
  const V normal = cross(ab, ac);
  const double area2 = square(normal);
  const double wc = dot(normal, cross(ab, ap));
  const double wb = dot(normal, cross(ap, ac));
  const double wa = dot(normal, cross(c - b, bp));
  const double sum = wa + wb + wc;
  const V foot = ((wa / sum) * a + (wb / sum) * b) + (wc / sum) * c;
  const double face = square(p - foot);
  double edges = 1e300;
  edges = minimum(fromSegment(p, a, b), edges);
  edges = minimum(fromSegment(p, b, c), edges);
  edges = minimum(fromSegment(p, c, a), edges);
  const bool plane = area2 > 1e-20 * square(ab) * square(ac);
  const bool over = (wa > 0.0) & (wb > 0.0) & (wc > 0.0);
  double r = (plane & over) ? face : edges;
  r = ((d6 >= 0.0) & (d5 <= d6)) ? square(cp) : r;
  r = ((d3 >= 0.0) & (d4 <= d3)) ? square(bp) : r;
  r = ((d1 <= 0.0) & (d2 <= 0.0)) ? square(ap) : r;
  return r;
}

/// Squared distance of the lines p0-p1 and q0-q1 where they come closest inside both segments, else 1e300.
CALOT_INLINE double fromInside(const V& p0, const V& p1, const V& q0, const V& q1) {
  const V d = p1 - p0;
  const V e = q1 - q0;
  const V w = p0 - q0;
  const V n = cross(d, e);
  const double denominator = square(n);
  const double s = dot(n, cross(e, w)) / denominator;
  const double t = dot(n, cross(d, w)) / denominator;
  const bool skew = denominator > 1e-24 * square(d) * square(e);
  const bool inside = (s > 0.0) & (s < 1.0) & (t > 0.0) & (t < 1.0);
  const double squared = square((p0 + s * d) - (q0 + t * e));
  return (skew & inside) ? squared : 1e300;
}

/// Does segment p0-p1 pass through the face?
CALOT_INLINE bool crosses(const V& p0, const V& p1, const V& a, const V& b, const V& c) {
  const V normal = cross(b - a, c - a);
  const double h0 = dot(normal, p0 - a);
  const double h1 = dot(normal, p1 - a);
  const double s = h0 / (h0 - h1);
  const V x = p0 + s * (p1 - p0);
  const double wa = dot(normal, cross(c - b, x - b));
  const double wb = dot(normal, cross(a - c, x - c));
  const double wc = dot(normal, cross(b - a, x - a));
  const bool sides = ((h0 < 0.0) & (h1 > 0.0)) | ((h0 > 0.0) & (h1 < 0.0));
  return sides & (wa >= 0.0) & (wb >= 0.0) & (wc >= 0.0) & (wa + wb + wc > 0.0);
}

CALOT_INLINE V cornerOf(const TriangleLanes& triangles, std::size_t k, std::size_t l) {
  return {triangles.corner[k][0][l], triangles.corner[k][1][l], triangles.corner[k][2][l]};
}

CALOT_LANE_KERNEL void segmentKernel(const TriangleLanes& triangles, const V& p0, const V& p1,
                                     double* __restrict squared) {
  // In passes, each small enough for the registers.
  double best[laneCount];
  for (std::size_t l = 0; l < laneCount; ++l) {
    best[l] = minimum(fromTriangle(p0, cornerOf(triangles, 0, l), cornerOf(triangles, 1, l), cornerOf(triangles, 2, l)),
                      1e300);
  }
  for (std::size_t l = 0; l < laneCount; ++l) {
    best[l] = minimum(fromTriangle(p1, cornerOf(triangles, 0, l), cornerOf(triangles, 1, l), cornerOf(triangles, 2, l)),
                      best[l]);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = k == 2 ? 0 : k + 1;
    for (std::size_t l = 0; l < laneCount; ++l) {
      const V q = cornerOf(triangles, k, l);
      best[l] = minimum(fromSegment(q, p0, p1), best[l]);
      best[l] = minimum(fromInside(p0, p1, q, cornerOf(triangles, next, l)), best[l]);
    }
  }
  for (std::size_t l = 0; l < laneCount; ++l) {
    const bool through =
        crosses(p0, p1, cornerOf(triangles, 0, l), cornerOf(triangles, 1, l), cornerOf(triangles, 2, l));
    squared[l] = through ? 0.0 : best[l];
  }
}

CALOT_LANE_KERNEL void pointKernel(const TriangleLanes& triangles, const V& p, double* __restrict squared) {
  for (std::size_t l = 0; l < laneCount; ++l) {
    squared[l] = fromTriangle(p, cornerOf(triangles, 0, l), cornerOf(triangles, 1, l), cornerOf(triangles, 2, l));
  }
}

V laneVector(const Vec3& v) { return {v[0], v[1], v[2]}; }

CALOT_LANE_KERNEL void boxKernel(const double (*lower)[laneCount], const double (*upper)[laneCount], const double* p,
                                 double* squared) {
  for (std::size_t from = 0; from < laneCount; from += 4) {
    FourDoubles sum{};
    for (std::size_t a = 0; a < 3; ++a) {
      FourDoubles below;
      FourDoubles above;
      readVector(lower[a] + from, below);
      readVector(upper[a] + from, above);
      below -= p[a];
      above = p[a] - above;
      FourDoubles d = below < above ? above : below;
      d = d >= 0.0 ? d : FourDoubles{};
      sum += d * d * (1.0 - 1e-12);
    }
    writeVector(sum, squared + from);
  }
}

}  // namespace

std::size_t trianglesInBox(const ContactSurface& surface, std::span<const Vec3> position, std::uint32_t patch,
                           const Box& box, std::array<std::uint32_t, ContactSurface::maxPatchTriangles>& near) {
  std::size_t count = 0;
  const ContactSurface::Patch& range = surface.patches()[patch];
  for (std::size_t i = range.first; i < range.last; ++i) {
    const Index3& t = surface.triangles()[i];
    const Vec3& a = position[static_cast<std::size_t>(t[0])];
    const Vec3& b = position[static_cast<std::size_t>(t[1])];
    const Vec3& c = position[static_cast<std::size_t>(t[2])];
    bool out = false;
    for (int k = 0; k < 3; ++k) {
      const double lower = std::min(std::min(a[k], b[k]), c[k]);
      const double upper = std::max(std::max(a[k], b[k]), c[k]);
      out |= upper < box.lower[k];
      out |= lower > box.upper[k];
    }
    near[count] = static_cast<std::uint32_t>(i);
    count += out ? 0 : 1;
  }
  return count;
}

void gatherTriangles(const ContactSurface& surface, std::span<const Vec3> position,
                     std::span<const std::uint32_t> triangles, TriangleLanes& out) {
  for (std::size_t l = 0; l < laneCount; ++l) {
    const Index3& t = surface.triangles()[triangles[std::min(l, triangles.size() - 1)]];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = position[static_cast<std::size_t>(t[static_cast<int>(k)])];
      for (std::size_t a = 0; a < 3; ++a) out.corner[k][a][l] = p[static_cast<int>(a)];
    }
  }
}

void segmentTriangleDistances(const TriangleLanes& triangles, const Vec3& p0, const Vec3& p1, LaneValues& squared) {
  segmentKernel(triangles, laneVector(p0), laneVector(p1), squared.data());
}

void pointTriangleDistances(const TriangleLanes& triangles, const Vec3& p, LaneValues& squared) {
  pointKernel(triangles, laneVector(p), squared.data());
}

void boxesOf(const TriangleLanes& triangles, BoundsLanes& out) {
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t l = 0; l < laneCount; ++l) {
      const double x = triangles.corner[0][a][l];
      const double y = triangles.corner[1][a][l];
      const double z = triangles.corner[2][a][l];
      out.lower[a][l] = std::min(std::min(x, y), z);
      out.upper[a][l] = std::max(std::max(x, y), z);
    }
  }
}

void boxDistances(const BoundsLanes& boxes, const Vec3& p, LaneValues& squared) {
  boxKernel(boxes.lower, boxes.upper, p.data(), squared.data());
}

bool isSliver(const TriangleLanes& triangles, std::size_t lane) {
  const auto corner = [&](std::size_t k) {
    return Vec3(triangles.corner[k][0][lane], triangles.corner[k][1][lane], triangles.corner[k][2][lane]);
  };
  const Vec3 ab = corner(1) - corner(0);
  const Vec3 ac = corner(2) - corner(0);
  return !(ab.cross(ac).squaredNorm() > 1e-6 * ab.squaredNorm() * ac.squaredNorm());
}

namespace {

/// Per group, a bit for each box whose squared distance from a point is at most `maximum`.
CALOT_LANE_KERNEL void ballKernel(const BoxLanes* const* boxes, std::size_t count, const float* lower,
                                  const float* upper, float maximum, std::uint8_t* hit) {
  for (std::size_t g = 0; g < count; ++g) {
    EightFloats sum{};
    for (std::size_t a = 0; a < 3; ++a) {
      EightFloats below;
      EightFloats above;
      readVector(boxes[g]->lower[a], below);
      readVector(boxes[g]->upper[a], above);
      below -= upper[a];
      above = lower[a] - above;
      EightFloats d = below < above ? above : below;
      d = d >= 0.0F ? d : EightFloats{};
      sum += d * d;
    }
    const EightInts bits = (sum <= maximum) & EightInts{1, 2, 4, 8, 16, 32, 64, 128};
    const FourInts four =
        __builtin_shufflevector(bits, bits, 0, 1, 2, 3) | __builtin_shufflevector(bits, bits, 4, 5, 6, 7);
    hit[g] = static_cast<std::uint8_t>((four[0] | four[1]) | (four[2] | four[3]));
  }
}

/// More than two units in the last place: a value scaled outward by this is rounded outward.
constexpr float outward = 2.5e-7F;

float below(double x) {
  const auto f = static_cast<float>(x);
  return f - std::abs(f) * outward;
}
float above(double x) {
  const auto f = static_cast<float>(x);
  return f + std::abs(f) * outward;
}

void empty(BoxLanes& boxes) {
  std::fill_n(&boxes.lower[0][0], 3 * laneCount, std::numeric_limits<float>::infinity());
  std::fill_n(&boxes.upper[0][0], 3 * laneCount, -std::numeric_limits<float>::infinity());
}

}  // namespace

PatchTriangles::Ball::Ball(const Vec3& p, double distance)
    : squared(static_cast<float>(distance * distance) * (1.0F + 4e-6F)) {
  for (int a = 0; a < 3; ++a) {
    lower[static_cast<std::size_t>(a)] = floatBelow(p[a]);
    upper[static_cast<std::size_t>(a)] = floatAbove(p[a]);
  }
}

void PatchTriangles::within(std::span<const BoxLanes* const> boxes, const Ball& ball, std::vector<std::uint8_t>& hit) {
  hit.resize(boxes.size());
  ballKernel(boxes.data(), boxes.size(), ball.lower.data(), ball.upper.data(), ball.squared, hit.data());
}

void PatchTriangles::begin(const ContactSurface& surface, std::span<const Vec3> position) {
  surface_ = &surface;
  position_ = position;
  patch_.resize(surface.patches().size());
  for (Patch& patch : patch_) patch.made = false;
}

void PatchTriangles::make(std::uint32_t patch) {
  Patch& own = patch_[patch];
  own.made = true;
  const std::size_t first = surface_->patches()[patch].first;
  const std::size_t last = surface_->patches()[patch].last;
  own.count = laneGroups(last - first);
  empty(own.whole);
  for (std::size_t g = 0; g < own.count; ++g) {
    Group& group = own.group[g];
    std::array<std::uint32_t, laneCount> triangle{};
    group.first = first + g * laneCount;
    const std::size_t count = std::min<std::size_t>(laneCount, last - group.first);
    std::iota(triangle.begin(), triangle.end(), static_cast<std::uint32_t>(group.first));
    gatherTriangles(*surface_, position_, {triangle.data(), count}, group.triangles);
    BoundsLanes exact;
    boxesOf(group.triangles, exact);
    group.slivers = 0;
    for (std::size_t l = 0; l < laneCount; ++l) group.slivers |= (isSliver(group.triangles, l) ? 1U : 0U) << l;
    empty(group.box);
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t l = 0; l < count; ++l) {
        group.box.lower[a][l] = below(exact.lower[a][l]);
        group.box.upper[a][l] = above(exact.upper[a][l]);
      }
      own.whole.lower[a][g] = *std::min_element(group.box.lower[a], group.box.lower[a] + laneCount);
      own.whole.upper[a][g] = *std::max_element(group.box.upper[a], group.box.upper[a] + laneCount);
    }
  }
}

void PatchTriangles::choose(std::span<const std::uint32_t> patches, const Box& box) {
  chosen_.clear();
  chosenBoxes_.clear();
  std::array<float, 3> lower{};
  std::array<float, 3> upper{};
  for (std::size_t a = 0; a < 3; ++a) {
    lower[a] = below(box.lower[static_cast<int>(a)]);
    upper[a] = above(box.upper[static_cast<int>(a)]);
  }
  for (const std::uint32_t p : patches) {
    const Patch& patch = of(p);
    for (std::size_t g = 0; g < patch.count; ++g) {
      bool out = false;
      for (std::size_t a = 0; a < 3; ++a) {
        out |= patch.whole.upper[a][g] < lower[a];
        out |= patch.whole.lower[a][g] > upper[a];
      }
      if (out) continue;
      const std::size_t lane = chosen_.size() % laneCount;
      if (lane == 0) empty(chosenBoxes_.emplace_back());
      for (std::size_t a = 0; a < 3; ++a) {
        chosenBoxes_.back().lower[a][lane] = patch.whole.lower[a][g];
        chosenBoxes_.back().upper[a][lane] = patch.whole.upper[a][g];
      }
      chosen_.push_back({p, static_cast<std::uint32_t>(g), &patch.group[g]});
    }
  }
  whole_.clear();
  for (const BoxLanes& boxes : chosenBoxes_) whole_.push_back(&boxes);
}

}  // namespace calot
