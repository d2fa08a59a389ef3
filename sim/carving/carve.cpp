// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/carving/carved_field.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sim/geometry/dwell.h"
#include "sim/math/linear.h"
#include "sim/math/vectors.h"

namespace calot {
namespace {

/// One lane's vector; everything below is free of branches, so that a loop over lanes becomes vectors.
struct V {
  double x, y, z;
};
CALOT_INLINE V operator-(const V& a, const V& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
CALOT_INLINE double dot(const V& a, const V& b) { return a.x * b.x + (a.y * b.y + a.z * b.z); }
CALOT_INLINE V cross(const V& a, const V& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Nearest point to the origin so far, and its squared distance.
struct Nearest {
  double squared;
  V point;
};
CALOT_INLINE void offer(Nearest& best, double squared, const V& p, bool valid) {
  const bool better = valid && squared < best.squared;
  best.squared = better ? squared : best.squared;
  best.point.x = better ? p.x : best.point.x;
  best.point.y = better ? p.y : best.point.y;
  best.point.z = better ? p.z : best.point.z;
}

CALOT_INLINE void offerSegment(Nearest& best, const V& a, const V& b) {
  const V e = b - a;
  const double length2 = dot(e, e);
  const double u = -dot(a, e) / (length2 > 0.0 ? length2 : 1.0);
  const double low = u > 0.0 ? u : 0.0;
  const double s = low < 1.0 ? low : 1.0;
  const V p{a.x + s * e.x, a.y + s * e.y, a.z + s * e.z};
  offer(best, dot(p, p), p, true);
}

CALOT_INLINE void offerFace(Nearest& best, const V& a, const V& b, const V& c) {
  const V ab = b - a;
  const V ac = c - a;
  const V n = cross(ab, ac);
  const double area2 = dot(n, n);
  const double wc = dot(n, cross(a, b));
  const double wa = dot(n, cross(b, c));
  const double wb = dot(n, cross(c, a));
  // A sliver's normal is noise; its sides are enough.
  const bool inside =
      bool(int(wa > 0.0) & int(wb > 0.0) & int(wc > 0.0) & int(area2 > 1e-20 * (dot(ab, ab) * dot(ac, ac))));
  const double height = dot(a, n) / (inside ? area2 : 1.0);
  const V p{height * n.x, height * n.y, height * n.z};
  offer(best, dot(p, p), p, inside);
}

CALOT_INLINE double minimum(double a, double b) { return a < b ? a : b; }
CALOT_INLINE double magnitude(double a) { return a < 0.0 ? -a : a; }
CALOT_INLINE double maximum(double a, double b) { return a > b ? a : b; }

/// Distance of the origin from [low, high], squared.
CALOT_INLINE double gap2(double low, double high) {
  const double g = maximum(maximum(low, -high), 0.0);
  return g * g;
}

/// Distance of each node within which potentials can exceed -reach: |F^T n| is at most the root of the greatest row sum
/// times the greatest column sum.
CALOT_LANE_KERNEL void reaches(const NodeLanes& n, double reach, double* out) {
  for (int i = 0; i < laneCount; ++i) {
    double row = -1.0;  // below all of them: a comparison with 0 would lose which zero it gives (linear.h)
    double column = -1.0;
    for (int k = 0; k < 3; ++k) {
      row = maximum(row, magnitude(n.gradient[3 * k][i]) + magnitude(n.gradient[3 * k + 1][i]) +
                             magnitude(n.gradient[3 * k + 2][i]));
      column = maximum(column,
                       magnitude(n.gradient[k][i]) + magnitude(n.gradient[k + 3][i]) + magnitude(n.gradient[k + 6][i]));
    }
    out[i] = reach * std::sqrt(row * column);
  }
}

/// 1 where a node is near enough for its potential to matter.
CALOT_LANE_KERNEL int anyNear(const SweptCapsule& c, const NodeLanes& n, const double* reach) {
  double near[laneCount];
  for (int i = 0; i < laneCount; ++i) {
    double distance2 = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double x = n.now[k][i];
      const double y = n.before[k][i];
      const double low = minimum(minimum(c.p0[k], c.p1[k]) - y, minimum(c.q0[k], c.q1[k]) - x);
      const double high = maximum(maximum(c.p0[k], c.p1[k]) - y, maximum(c.q0[k], c.q1[k]) - x);
      distance2 += gap2(low, high);
    }
    const double limit = c.radius + reach[i];
    near[i] = limit * limit - distance2;
  }
  int any = 0;
  for (int i = 0; i < laneCount; ++i) any |= int(near[i] >= 0.0);
  return any;
}

CALOT_LANE_KERNEL void potentials(const SweptCapsule& c, const NodeLanes& n, double* out) {
  const V p0{c.p0[0], c.p0[1], c.p0[2]};
  const V p1{c.p1[0], c.p1[1], c.p1[2]};
  const V q0{c.q0[0], c.q0[1], c.q0[2]};
  const V q1{c.q1[0], c.q1[1], c.q1[2]};
  const double radius = c.radius;
  for (int i = 0; i < laneCount; ++i) {
    const V x{n.now[0][i], n.now[1][i], n.now[2][i]};
    const V y{n.before[0][i], n.before[1][i], n.before[2][i]};
    // Relative to the node; translating the previous segment with the tissue makes it relative to
    // the node's previous position.
    const V a = p0 - y;
    const V b = p1 - y;
    const V d = q1 - x;
    const V e = q0 - x;
    Nearest best{1e300, {0.0, 0.0, 0.0}};
    offerSegment(best, e, d);
    offerSegment(best, a, b);
    offerSegment(best, a, e);
    offerSegment(best, b, d);
    offerSegment(best, a, d);
    offerFace(best, a, b, d);
    offerFace(best, a, d, e);
    const double distance = std::sqrt(best.squared);
    const V& g = best.point;
    const double fx = n.gradient[0][i] * g.x + (n.gradient[3][i] * g.y + n.gradient[6][i] * g.z);
    const double fy = n.gradient[1][i] * g.x + (n.gradient[4][i] * g.y + n.gradient[7][i] * g.z);
    const double fz = n.gradient[2][i] * g.x + (n.gradient[5][i] * g.y + n.gradient[8][i] * g.z);
    const double carried = std::sqrt(fx * fx + (fy * fy + fz * fz));
    const bool rate = bool(int(distance > 0.0) & int(carried > 1e-6 * distance));
    const double value = (radius - distance) * ((rate ? distance : 1.0) / (rate ? carried : 1.0));
    out[i] = out[i] < value ? value : out[i];
  }
}

}  // namespace

bool toolPotential(std::span<const SweptCapsule> tool, const NodeLanes& nodes, double reach, double (&out)[laneCount]) {
  double reached[laneCount];
  reaches(nodes, reach, reached);
  bool any = false;
  for (const SweptCapsule& capsule : tool) {
    if (anyNear(capsule, nodes, reached) == 0) continue;
    potentials(capsule, nodes, out);
    any = true;
  }
  return any;
}

void UndeformedTissue::fillLanes(std::size_t /*box*/, const Index3& first, int count, NodeLanes& out) const {
  const Vec3 at = lattice_.position(first);
  for (int i = 0; i < count; ++i) {
    out.now[0][i] = lattice_.origin()[0] + lattice_.cell() * static_cast<double>(first[0] + i);
    out.now[1][i] = at[1];
    out.now[2][i] = at[2];
    for (int k = 0; k < 9; ++k) out.gradient[k][i] = k % 4 == 0 ? 1.0 : 0.0;
  }
  for (int k = 0; k < 3; ++k) std::copy(out.now[k], out.now[k] + count, out.before[k]);
}

Box sweptBounds(std::span<const SweptCapsule> tool, double depth, double stretch) {
  Box box;
  for (const SweptCapsule& c : tool) {
    Box one;
    for (const Vec3* p : {&c.p0, &c.p1, &c.q0, &c.q1}) one.include(*p);
    one.grow(c.radius + depth * stretch);
    box.include(one.lower);
    box.include(one.upper);
  }
  return box;
}

NodeBox nodesWithin(const BrickLattice& lattice, const Box& bounds) {
  NodeBox box;
  for (int a = 0; a < 3; ++a) {
    const double last = static_cast<double>(lattice.nodes()[a]);
    const double low = std::min(notNegative((bounds.lower[a] - lattice.origin()[a]) / lattice.cell()), last);
    const double high = std::min(notNegative((bounds.upper[a] - lattice.origin()[a]) / lattice.cell() + 1.0), last);
    box.lower[a] = static_cast<int>(low);
    box.upper[a] = static_cast<int>(high);
  }
  return box;
}

namespace {

/// Upper bound of a node's field in this step.
double risen(std::span<const SweptCapsule> tool, const NodeLanes& lanes, int lane, double value, double rise) {
  const MovingPoint node{{lanes.before[0][lane], lanes.before[1][lane], lanes.before[2][lane]},
                         {lanes.now[0][lane], lanes.now[1][lane], lanes.now[2][lane]}};
  StepIntervals above;
  for (const SweptCapsule& c : tool) {
    if (c.radius > value) above.add(near({{c.p0, c.p1}, {c.q0, c.q1}, c.radius}, node, -value));
  }
  return value + rise * above.length();
}

}  // namespace

void carve(CarvedField& field, std::span<const SweptCapsule> tool, std::span<const NodeBox> boxes,
           const TissueMotion& motion, double depth, double rise) {
  const BrickLattice& lattice = field.lattice();
  const double band = field.band();
  NodeLanes lanes;
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    const NodeBox& box = boxes[b];
    assert((box.lower.array() >= 0).all() && (box.upper.array() <= lattice.nodes().array()).all());
    for (int z = box.lower[2]; z < box.upper[2]; ++z) {
      for (int y = box.lower[1]; y < box.upper[1]; ++y) {
        for (int x = box.lower[0]; x < box.upper[0];) {
          const Index3 first(x, y, z);
          const int count = std::min(box.upper[0] - x, 8 - (x & 7));
          x += count;
          const std::uint32_t node = lattice.node(first);
          const double* value = field.values().data() + node;
          if (std::all_of(value, value + count, [band](double v) { return v >= band; })) continue;
          motion.fillLanes(b, first, count, lanes);
          for (int i = count; i < laneCount; ++i) {  // idle lanes repeat the first
            for (auto& row : lanes.now) row[i] = row[0];
            for (auto& row : lanes.before) row[i] = row[0];
            for (auto& row : lanes.gradient) row[i] = row[0];
          }
          double potential[laneCount];
          std::fill(potential, potential + laneCount, -1e300);
          if (!toolPotential(tool, lanes, depth, potential)) continue;
          // Deeper nodes stay unchanged even if another lane is not.
          for (double& p : potential) p = p >= -depth ? p : -1e300;
          if (rise < std::numeric_limits<double>::infinity()) {
            for (int i = 0; i < count; ++i) {
              if (potential[i] > value[i]) potential[i] = std::min(potential[i], risen(tool, lanes, i, value[i], rise));
            }
          }
          field.raiseRow(node, {potential, slot(count)});
        }
      }
    }
  }
}

}  // namespace calot
