// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/fat/fat_body.h"

#include <algorithm>
#include <cmath>

namespace calot {

namespace {

constexpr int directions = 27;

/// The cube along a row of nodes: position and its derivatives by y and z at both ends of x. Plain numbers for speed:
/// evaluated for each row of nodes.
struct Row {
  double at[2][3];
  double alongY[2][3];
  double alongZ[2][3];
};

void rowOf(const Index8& corner, std::span<const Vec3> p, double y, double z, Row& row) {
  for (std::size_t x = 0; x < 2; ++x) {
    const double* a = p[static_cast<std::size_t>(corner[x])].data();
    const double* b = p[static_cast<std::size_t>(corner[x + 2])].data();
    const double* c = p[static_cast<std::size_t>(corner[x + 4])].data();
    const double* d = p[static_cast<std::size_t>(corner[x + 6])].data();
    for (std::size_t r = 0; r < 3; ++r) {
      const double first = b[r] - a[r];
      const double second = d[r] - c[r];
      const double low = a[r] + y * first;
      const double high = c[r] + y * second;
      row.at[x][r] = low + z * (high - low);
      row.alongY[x][r] = first + z * (second - first);
      row.alongZ[x][r] = high - low;
    }
  }
}

}  // namespace

CubeMotion::CubeMotion(const FatModel& model) : model_(model) {
  box_.reserve(slot(directions) * model.solid().cubes().size());
  cube_.reserve(box_.capacity());
}

void CubeMotion::choose(std::span<const SweptCapsule> tool, std::span<const Vec3> now, std::span<const Vec3> before,
                        std::span<const double> fill, double depth) {
  now_ = now;
  before_ = before;
  box_.clear();
  cube_.clear();
  const Box bounds = sweptBounds(tool, 0.0, 0.0);
  for (std::size_t c = 0; c < fill.size(); ++c) {
    if (!(fill[c] > 0.0)) continue;
    const Index8& corner = model_.solid().cubes()[c];
    Box own;
    for (const int n : corner) {
      own.include(now_[slot(n)]);
      own.include(before_[slot(n)]);
    }
    const Reach reach = reachOf(corner, depth);
    own.grow(reach.depth + ((reach.beyond[0] + reach.beyond[1]) + reach.beyond[2]));
    if (own.overlaps(bounds)) add(static_cast<int>(c), bounds, reach, fill);
  }
}

/// Entries of F within a cube lie between those along its edges, and |F^T n| is at most the root of the greatest row
/// sum times the greatest column sum.
CubeMotion::Reach CubeMotion::reachOf(const Index8& corner, double depth) const {
  double entry[3][3] = {};
  double length2[3] = {};
  for (std::size_t c = 0; c < 8; ++c) {
    const double* from = now_[slot(corner[c])].data();
    for (std::size_t a = 0; a < 3; ++a) {
      if ((c >> a & 1U) != 0) continue;
      const double* to = now_[slot(corner[c + (std::size_t{1} << a)])].data();
      double sum = 0.0;
      for (std::size_t r = 0; r < 3; ++r) {
        const double d = to[r] - from[r];
        entry[r][a] = std::max(entry[r][a], std::abs(d));
        sum += d * d;
      }
      length2[a] = std::max(length2[a], sum);
    }
  }
  double row = 0.0;
  double column = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    row = std::max(row, (entry[k][0] + entry[k][1]) + entry[k][2]);
    column = std::max(column, (entry[0][k] + entry[1][k]) + entry[2][k]);
  }
  Reach reach;
  reach.depth = depth * std::sqrt(row * column) / (model_.lattice().cell() * model_.cellsPerCube());
  for (std::size_t a = 0; a < 3; ++a) reach.beyond[a] = std::sqrt(length2[a]) / model_.cellsPerCube();
  return reach;
}

/// Adds the nodes of a cube, and the layers of nodes around it that belong to no remaining cube, within reach
/// of the tool's bounds.
void CubeMotion::add(int cube, const Box& tool, const Reach& reach, std::span<const double> fill) {
  const Index8& corner = model_.solid().cubes()[slot(cube)];
  const Index3& h = model_.hexahedronOfCube(cube);
  const int k = model_.cellsPerCube();
  const Index3 nodes = model_.lattice().nodes();
  const Index3 lower = k * h;
  Index3 upper = lower.array() + k;
  for (int a = 0; a < 3; ++a) {
    if (h[a] == model_.hexahedra()[a] - 1) ++upper[a];
  }
  for (int d = 0; d < directions; ++d) {
    const Index3 way(d % 3 - 1, d / 3 % 3 - 1, d / 9 - 1);
    if (!way.isZero()) {
      const int neighbour = model_.cubeAt(h + way);
      if (neighbour >= 0 && fill[slot(neighbour)] > 0.0) continue;
    }
    NodeBox box{lower, upper};
    double grow = reach.depth;
    for (int a = 0; a < 3; ++a) {
      if (way[a] == 0) continue;
      box.lower[a] = way[a] < 0 ? lower[a] - 1 : upper[a];
      box.upper[a] = box.lower[a] + 1;
      grow += reach.beyond[a];
    }
    if ((box.lower.array() < 0).any() || (box.upper.array() > nodes.array()).any()) continue;
    Box bounds;
    for (int c = 0; c < 8; ++c) {
      bool beside = true;
      for (int a = 0; a < 3; ++a) beside = beside && (way[a] == 0 || (c >> a & 1) == (way[a] > 0 ? 1 : 0));
      if (!beside) continue;
      bounds.include(now_[slot(corner[slot(c)])]);
      bounds.include(before_[slot(corner[slot(c)])]);
    }
    bounds.grow(grow);
    if (!bounds.overlaps(tool)) continue;
    box_.push_back(box);
    cube_.push_back(cube);
  }
}

void CubeMotion::fillLanes(std::size_t box, const Index3& first, int count, NodeLanes& out) const {
  const int cube = cube_[box];
  const Index8& corner = model_.solid().cubes()[slot(cube)];
  const Index3& h = model_.hexahedronOfCube(cube);
  const auto k = static_cast<double>(model_.cellsPerCube());
  const auto local = [&](int a, int n) { return static_cast<double>(n - model_.cellsPerCube() * h[a]) / k; };
  const double y = local(1, first[1]);
  const double z = local(2, first[2]);
  Row now;
  Row before;
  rowOf(corner, now_, y, z, now);
  rowOf(corner, before_, y, z, before);
  const double edge = model_.lattice().cell() * k;
  for (int i = 0; i < count; ++i) {
    const double s = local(0, first[0] + i);
    for (int r = 0; r < 3; ++r) {
      out.now[r][i] = now.at[0][r] + s * (now.at[1][r] - now.at[0][r]);
      out.before[r][i] = before.at[0][r] + s * (before.at[1][r] - before.at[0][r]);
      out.gradient[3 * r][i] = (now.at[1][r] - now.at[0][r]) / edge;
      out.gradient[3 * r + 1][i] = (now.alongY[0][r] + s * (now.alongY[1][r] - now.alongY[0][r])) / edge;
      out.gradient[3 * r + 2][i] = (now.alongZ[0][r] + s * (now.alongZ[1][r] - now.alongZ[0][r])) / edge;
    }
  }
}

}  // namespace calot
