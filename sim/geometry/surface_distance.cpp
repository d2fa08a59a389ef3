// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/geometry/surface_report.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"

namespace calot {
namespace {

constexpr int leafSize = 4;
constexpr double pi = 3.14159265358979323846;

double squaredDistanceToBox(const Vec3& p, const Box& box) {
  return notNegative(Vec3((box.lower - p).cwiseMax(p - box.upper))).squaredNorm();
}

/// Solid angle of a triangle over 4 pi (Van Oosterom and Strackee 1983).
double solidAngleShare(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 x = a - p;
  const Vec3 y = b - p;
  const Vec3 z = c - p;
  const double lx = x.norm();
  const double ly = y.norm();
  const double lz = z.norm();
  const double numerator = x.dot(y.cross(z));
  const double denominator = lx * ly * lz + x.dot(y) * lz + y.dot(z) * lx + z.dot(x) * ly;
  return 2.0 * arctangent2(numerator, denominator) / (4.0 * pi);
}

}  // namespace

SurfaceDistance::SurfaceDistance(TriangleMesh mesh, InsideRule rule) : mesh_(std::move(mesh)), rule_(rule) {
  if (rule_ == InsideRule::automatic) {
    rule_ = inspectSurface(mesh_).closedManifold() ? InsideRule::pseudonormal : InsideRule::winding;
  }
  const int n = mesh_.triangles();
  std::vector<Vec3> centroid(slot(n));
  order_.resize(slot(n));
  for (int t = 0; t < n; ++t) {
    centroid[slot(t)] = (mesh_.corner(t, 0) + mesh_.corner(t, 1) + mesh_.corner(t, 2)) / 3.0;
    order_[slot(t)] = t;
  }
  node_.reserve(slot(n));
  if (n > 0) build(0, n, centroid);
  if (rule_ == InsideRule::pseudonormal) computePseudonormals();
}

int SurfaceDistance::build(int first, int last, const std::vector<Vec3>& centroid) {
  const int index = static_cast<int>(node_.size());
  node_.emplace_back();
  Node node;
  Box centres;
  Vec3 weighted = Vec3::Zero();
  double area = 0.0;
  for (int i = first; i < last; ++i) {
    const int t = order_[slot(i)];
    for (int k = 0; k < 3; ++k) node.box.include(mesh_.corner(t, k));
    centres.include(centroid[slot(t)]);
    const Vec3& a = mesh_.corner(t, 0);
    const Vec3 n = 0.5 * (mesh_.corner(t, 1) - a).cross(mesh_.corner(t, 2) - a);
    const double w = n.norm();
    node.dipole += n;
    weighted += w * centroid[slot(t)];
    area += w;
  }
  node.centre = area > 0.0 ? Vec3(weighted / area) : Vec3(0.5 * (node.box.lower + node.box.upper));
  node.radius = (node.box.upper - node.centre).cwiseMax(node.centre - node.box.lower).norm();
  if (last - first <= leafSize) {
    std::sort(order_.begin() + first, order_.begin() + last);
    node.first = first;
    node.count = last - first;
    node_[slot(index)] = node;
    return index;
  }
  int axis = 0;
  (centres.upper - centres.lower).maxCoeff(&axis);
  std::sort(order_.begin() + first, order_.begin() + last, [&centroid, axis](int x, int y) {
    const double cx = centroid[slot(x)][axis];
    const double cy = centroid[slot(y)][axis];
    return cx != cy ? cx < cy : x < y;
  });
  const int middle = first + (last - first) / 2;
  build(first, middle, centroid);
  node.right = build(middle, last, centroid);
  node_[slot(index)] = node;
  return index;
}

void SurfaceDistance::computePseudonormals() {
  const std::size_t n = mesh_.triangle.size();
  faceNormal_.assign(n, Vec3::Zero());
  edgeNormal_.assign(n, {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()});
  vertexNormal_.assign(mesh_.vertex.size(), Vec3::Zero());
  for (int t = 0; t < mesh_.triangles(); ++t) {
    const Vec3& a = mesh_.corner(t, 0);
    const Vec3 normal = (mesh_.corner(t, 1) - a).cross(mesh_.corner(t, 2) - a);
    const double length = normal.norm();
    if (!(length > 0.0)) continue;
    faceNormal_[slot(t)] = normal / length;
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = mesh_.corner(t, (k + 1) % 3) - mesh_.corner(t, k);
      const Vec3 v = mesh_.corner(t, (k + 2) % 3) - mesh_.corner(t, k);
      const double angle = arctangent2(u.cross(v).norm(), u.dot(v));
      vertexNormal_[slot(mesh_.triangle[slot(t)][k])] += angle * faceNormal_[slot(t)];
    }
  }
  const std::vector<Index3> neighbour = triangleNeighbours(mesh_);
  for (std::size_t t = 0; t < n; ++t) {
    for (int k = 0; k < 3; ++k) {
      const int other = neighbour[t][k];
      edgeNormal_[t][slot(k)] = other < 0 ? faceNormal_[t] : Vec3(faceNormal_[t] + faceNormal_[slot(other)]);
    }
  }
}

void SurfaceDistance::search(const Vec3& p, Closest& best) const {
  struct Entry {
    int node;
    double bound;
  };
  std::array<Entry, 64> stack;  // the depth is at most log2 of the number of triangles, one sibling waits at each level
  std::size_t height = 0;
  stack[height++] = {0, squaredDistanceToBox(p, node_.front().box)};
  while (height > 0) {
    const Entry entry = stack[--height];
    if (entry.bound > best.on.squaredDistance) continue;
    const Node& node = node_[slot(entry.node)];
    if (node.count > 0) {
      for (int i = node.first; i < node.first + node.count; ++i) {
        const int t = order_[slot(i)];
        const PointTriangle on = closestOnTriangle(p, mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2));
        if (on.squaredDistance < best.on.squaredDistance ||
            (on.squaredDistance == best.on.squaredDistance && t < best.triangle)) {
          best = {t, on};
        }
      }
      continue;
    }
    const int left = entry.node + 1;
    const double toLeft = squaredDistanceToBox(p, node_[slot(left)].box);
    const double toRight = squaredDistanceToBox(p, node_[slot(node.right)].box);
    if (toLeft <= toRight) {
      stack[height++] = {node.right, toRight};
      stack[height++] = {left, toLeft};
    } else {
      stack[height++] = {left, toLeft};
      stack[height++] = {node.right, toRight};
    }
  }
}

SurfaceDistance::Closest SurfaceDistance::closest(const Vec3& p) const {
  Closest best;
  best.on.squaredDistance = 1e300;
  if (!node_.empty()) search(p, best);
  return best;
}

SurfaceDistance::Closest SurfaceDistance::closest(const Vec3& p, int guess) const {
  Closest best;
  best.triangle = guess;
  best.on = closestOnTriangle(p, mesh_.corner(guess, 0), mesh_.corner(guess, 1), mesh_.corner(guess, 2));
  search(p, best);
  return best;
}

double SurfaceDistance::windingNumber(const Vec3& p) const {
  // A cluster farther than this many radii is approximated by one dipole: the total error stays below a tenth, and the
  // test is whether the sum exceeds one half.
  constexpr double farAway = 2.0;
  double sum = 0.0;
  std::array<int, 64> stack;
  std::size_t height = 0;
  if (!node_.empty()) stack[height++] = 0;
  while (height > 0) {
    const int index = stack[--height];
    const Node& node = node_[slot(index)];
    const Vec3 r = node.centre - p;
    const double distance = r.norm();
    if (distance > farAway * node.radius) {
      sum += node.dipole.dot(r) / (4.0 * pi * distance * distance * distance);
    } else if (node.count > 0) {
      for (int i = node.first; i < node.first + node.count; ++i) {
        const int t = order_[slot(i)];
        sum += solidAngleShare(p, mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2));
      }
    } else {
      stack[height++] = node.right;
      stack[height++] = index + 1;
    }
  }
  return sum;
}

double SurfaceDistance::signedDistance(const Vec3& p) const { return signedDistance(p, closest(p)); }

double SurfaceDistance::signedDistance(const Vec3& p, const Closest& closest) const {
  const double distance = std::sqrt(closest.on.squaredDistance);
  if (rule_ == InsideRule::winding) return windingNumber(p) > 0.5 ? -distance : distance;
  const auto feature = static_cast<int>(closest.on.feature);
  const std::size_t t = slot(closest.triangle);
  Vec3 normal = faceNormal_[t];
  if (feature >= 4) {
    normal = vertexNormal_[slot(mesh_.triangle[t][feature - 4])];
  } else if (feature >= 1) {
    normal = edgeNormal_[t][slot(feature - 1)];
  }
  return normal.dot(p - closest.on.point) < 0.0 ? -distance : distance;
}

}  // namespace calot
