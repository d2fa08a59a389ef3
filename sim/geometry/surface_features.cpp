// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"
//
#include "sim/geometry/surface_features.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "sim/math/elementary.h"

namespace calot {

SurfaceFeatures::SurfaceFeatures(std::span<const Vec3> vertex, std::span<const Index3> triangle) {
  face_.resize(triangle.size());
  vertexNormal_.assign(vertex.size(), Vec3::Zero());
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    std::array<const Vec3*, 3> p{};
    for (int k = 0; k < 3; ++k) p[slot(k)] = &vertex[slot(triangle[t][k])];
    const Vec3 ab = *p[1] - *p[0];
    const Vec3 ac = *p[2] - *p[0];
    const Vec3 normal = ab.cross(ac);
    if (!(normal.squaredNorm() > 1e-20 * ab.squaredNorm() * ac.squaredNorm())) continue;
    Face& face = face_[t];
    face.normal = normal / normal.norm();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 u = *p[(k + 1) % 3] - *p[k];
      const Vec3 v = *p[(k + 2) % 3] - *p[k];
      const Vec3 inward = face.normal.cross(u);
      face.inward[k] = inward / inward.norm();
      const double angle = arctangent2(u.cross(v).norm(), u.dot(v));
      vertexNormal_[slot(triangle[t][static_cast<int>(k)])] += angle * face.normal;
    }
  }
  makeEdges(vertex.size(), triangle);
}

void SurfaceFeatures::makeEdges(std::size_t vertices, std::span<const Index3> triangle) {
  // Sides into buckets by their lower vertex, a few to each, sorted there.
  std::vector<int> start(vertices + 1, 0);
  for (const Index3& v : triangle) {
    for (int k = 0; k < 3; ++k) ++start[slot(std::min(v[k], v[(k + 1) % 3])) + 1];
  }
  for (std::size_t i = 1; i <= vertices; ++i) start[i] += start[i - 1];
  side_.resize(3 * triangle.size());
  std::vector<int> at(start.begin(), start.end() - 1);
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = triangle[t][k];
      const int to = triangle[t][(k + 1) % 3];
      const int low = std::min(from, to);
      side_[slot(at[slot(low)]++)] = {static_cast<int>(t), k, low, std::max(from, to), from < to};
    }
  }
  const auto before = [](const Side& x, const Side& y) {
    return std::tie(x.high, x.triangle, x.side) < std::tie(y.high, y.triangle, y.side);
  };
  edge_.reserve(side_.size() / 2 + 1);
  aroundStart_.assign(vertices + 1, 0);
  for (std::size_t low = 0; low < vertices; ++low) {
    const int last = start[low + 1];
    std::sort(side_.begin() + start[low], side_.begin() + last, before);
    for (int i = start[low]; i < last;) {
      Edge edge;
      edge.low = static_cast<int>(low);
      edge.high = side_[slot(i)].high;
      edge.first = i;
      int balance = 0;
      for (; i < last && side_[slot(i)].high == edge.high; ++i) {
        const Side& side = side_[slot(i)];
        balance += side.forward ? 1 : -1;
        edge.normal += face_[slot(side.triangle)].normal;
      }
      edge.last = i;
      openEdges_ += balance != 0 ? 1 : 0;
      manifold_ = manifold_ && balance == 0 && edge.last - edge.first == 2;
      ++aroundStart_[low + 1];
      ++aroundStart_[slot(edge.high) + 1];
      edge_.push_back(edge);
    }
  }
  for (std::size_t i = 1; i <= vertices; ++i) aroundStart_[i] += aroundStart_[i - 1];
  around_.resize(2 * edge_.size());
  at.assign(aroundStart_.begin(), aroundStart_.end() - 1);
  for (std::size_t e = 0; e < edge_.size(); ++e) {
    around_[slot(at[slot(edge_[e].low)]++)] = static_cast<int>(e);
    around_[slot(at[slot(edge_[e].high)]++)] = static_cast<int>(e);
  }
}

}  // namespace calot
