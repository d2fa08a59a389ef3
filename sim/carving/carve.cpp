// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"
//
#include "sim/carving/carve.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sim/geometry/dwell.h"
#include "sim/math/bounds.h"

namespace calot {

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

/// What a node's field can rise to in this step.
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
