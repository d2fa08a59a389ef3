// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/surface_surface.h"

#include <cmath>
#include <numeric>

#include "sim/contact/surface_normal.h"
#include "sim/contact/triangle_lanes.h"
#include "sim/geometry/closest_point.h"

namespace calot {

namespace {

constexpr double onSurface = 1e-9;  // m: nearer than this, the direction of the distance is noise

/// Triangles of some patches in lanes, with their boxes.
class Candidates {
 public:
  Candidates(const ContactSurface& surface, std::span<const Vec3> position) : surface_(surface), position_(position) {}

  /// Takes in what of the patches overlaps the box.
  void gather(std::span<const std::uint32_t> patches, const Box& box) {
    triangle_.clear();
    std::array<std::uint32_t, ContactSurface::largestPatch> near{};
    for (const std::uint32_t p : patches) {
      const std::size_t count = trianglesInBox(surface_, position_, p, box, near);
      triangle_.insert(triangle_.end(), near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count));
    }
    group_.resize(laneGroups(triangle_.size()));
    bounds_.resize(group_.size());
    whole_.resize(group_.size());
    for (std::size_t g = 0; g < group_.size(); ++g) {
      gatherTriangles(surface_, position_, lanesOf(g), group_[g]);
      boundsOf(group_[g], bounds_[g], whole_[g]);
    }
  }

  /// Calls f(triangle, squared distance) for every triangle no farther from p than `best` (m^2), which f may lower.
  /// @param first group to begin with: one that is near lowers `best` early
  /// @return the last group in which f lowered it, or `first`
  template <class F>
  std::size_t forEachNear(const Vec3& p, double& best, F&& f, std::size_t first = 0) const {
    std::size_t lowered = first;
    for (std::size_t k = 0; k < group_.size(); ++k) {
      const std::size_t g = k == 0 ? first : (k <= first ? k - 1 : k);
      if (boxDistance(whole_[g], p) > best) continue;
      const double before = best;
      LaneValues squared;
      boxDistances(bounds_[g], p, squared);
      if (!anyWithin(squared, best)) continue;
      pointTriangleDistances(group_[g], p, squared);
      const std::span<const std::uint32_t> lanes = lanesOf(g);
      for (std::size_t l = 0; l < lanes.size(); ++l) {
        if (squared[l] <= best) f(lanes[l], squared[l]);
      }
      if (best < before) lowered = g;
    }
    return lowered;
  }

 private:
  struct Bounds {
    alignas(64) double lower[3][laneCount];
    alignas(64) double upper[3][laneCount];
  };

  static void boundsOf(const TriangleLanes& group, Bounds& bounds, Box& whole) {
    whole = Box{};
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t l = 0; l < laneCount; ++l) {
        const double x = group.corner[0][a][l];
        const double y = group.corner[1][a][l];
        const double z = group.corner[2][a][l];
        bounds.lower[a][l] = std::min(std::min(x, y), z);
        bounds.upper[a][l] = std::max(std::max(x, y), z);
        whole.lower[static_cast<int>(a)] = std::min(whole.lower[static_cast<int>(a)], bounds.lower[a][l]);
        whole.upper[static_cast<int>(a)] = std::max(whole.upper[static_cast<int>(a)], bounds.upper[a][l]);
      }
    }
  }

  /// A little less than the squared distance of p from each box, so that rounding loses no triangle.
  static void boxDistances(const Bounds& bounds, const Vec3& p, LaneValues& squared) {
    squared.fill(0.0);
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = p[static_cast<int>(a)];
      for (std::size_t l = 0; l < laneCount; ++l) {
        const double d = std::max(std::max(bounds.lower[a][l] - x, x - bounds.upper[a][l]), 0.0);
        squared[l] += d * d * (1.0 - 1e-12);
      }
    }
  }

  /// The same for the box of a whole group: not above that of any of its triangles, as rounding is monotonic.
  static double boxDistance(const Box& box, const Vec3& p) {
    double squared = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double d = std::max(std::max(box.lower[a] - p[a], p[a] - box.upper[a]), 0.0);
      squared += d * d * (1.0 - 1e-12);
    }
    return squared;
  }

  static bool anyWithin(const LaneValues& squared, double best) {
    double least = squared[0];
    for (std::size_t l = 1; l < laneCount; ++l) least = std::min(least, squared[l]);
    return least <= best;
  }

  [[nodiscard]] std::span<const std::uint32_t> lanesOf(std::size_t g) const {
    const std::size_t first = g * laneCount;
    return {triangle_.data() + first, std::min<std::size_t>(laneCount, triangle_.size() - first)};
  }

  const ContactSurface& surface_;
  std::span<const Vec3> position_;
  std::vector<std::uint32_t> triangle_;
  std::vector<TriangleLanes> group_;
  std::vector<Bounds> bounds_;
  std::vector<Box> whole_;  ///< of each group
};

struct Near {
  bool found = false;
  std::size_t triangle = 0;
  PointTriangle point;
  Vec3 normal = Vec3::Zero();  ///< unit, towards the vertex or outward
  double distance = 0.0;       ///< signed (m)
};

/// How the nodes of a patch have been displaced since rest: their mean, and how far the farthest is from it (m).
struct Displacement {
  Vec3 mean = Vec3::Zero();
  double spread = -1.0;
};

Displacement displacementOf(std::span<const int> nodes, std::span<const Vec3> position, std::span<const Vec3> rest) {
  Displacement d;
  d.spread = 0.0;
  if (nodes.empty()) return d;
  for (const int n : nodes) d.mean += position[static_cast<std::size_t>(n)] - rest[static_cast<std::size_t>(n)];
  d.mean /= static_cast<double>(nodes.size());
  for (const int n : nodes) {
    const auto i = static_cast<std::size_t>(n);
    d.spread = std::max(d.spread, (position[i] - rest[i] - d.mean).squaredNorm());
  }
  d.spread = std::sqrt(d.spread) + 1e-9;  // rounding
  return d;
}

Box boundsOf(const ContactSurface& surface, std::span<const Vec3> position, std::uint32_t patch, double margin) {
  Box box;
  for (const int v : surface.patchNodes(patch)) box.include(position[static_cast<std::size_t>(v)]);
  box.grow(margin);
  return box;
}

std::vector<std::uint32_t> allPatches(const ContactSurface& surface) {
  std::vector<std::uint32_t> all(surface.patches().size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

}  // namespace

/// Nearest points of a surface to vertices of another surface or of itself.
class SurfaceSearch {
 public:
  SurfaceSearch(const SurfacePair& pair, const ContactSurface& a, std::span<const Vec3> positionA,
                const ContactSurface& b, std::span<const Vec3> positionB)
      : pair_(pair),
        a_(a),
        positionA_(positionA),
        b_(b),
        positionB_(positionB),
        candidates_(b, positionB),
        displacement_(b.patches().size()) {}

  /// Takes one patch of vertices and the patches of triangles near it. @return false: none of it can be in contact
  bool take(std::uint32_t patch, std::span<const std::uint32_t> near, double reach) {
    const Displacement mine = displacementOf(a_.patchNodes(patch), positionA_, pair_.restA_);
    const double limit = pair_.search(patch, reach);
    const bool clear = pair_.depth_[patch] == deepestOverlap;  // at rest, no vertex was inside
    bool any = false;
    kept_.clear();
    near_ = near;
    for (const std::uint32_t p : near) {
      Displacement& other = displacement_[p];
      if (other.spread < 0.0) other = displacementOf(b_.patchCorners(p), positionB_, pair_.restB_);
      const double least = pair_.patchDistance_[patch * pair_.patchesB_ + p] -
                           ((mine.mean - other.mean).norm() + mine.spread + other.spread);
      any = any || !clear || least <= reach;
      if (least <= limit) kept_.push_back(p);
    }
    if (!any || kept_.empty()) return false;
    candidates_.gather(kept_, boundsOf(a_, positionA_, patch, limit));
    last_ = 0;
    return true;
  }

  /// For rest: every triangle that reaches into the box.
  void take(const Box& box) {
    candidates_.gather(allPatches(b_), box);
    last_ = 0;
  }

  /// Can it be told from the displacements that a vertex of the patch taken is outside, farther than `reach`?
  [[nodiscard]] bool surelyFar(std::size_t vertex, double reach) const {
    if (pair_.offset_[vertex] < 0.0) return false;
    const Vec3 mine = positionA_[vertex] - pair_.restA_[vertex];
    const double least = pair_.vertexDistance_[vertex] - reach;
    for (const std::uint32_t p : near_) {
      const Displacement& d = displacement_[p];
      const double free = least - d.spread;
      if (!(free > 0.0) || (mine - d.mean).squaredNorm() >= free * free) return false;
    }
    return true;
  }

  /// The least distance, ties to the lower triangle: in which order groups are looked at changes nothing, but the one
  /// where the last vertex, most often a neighbour, found its own makes the others short.
  [[nodiscard]] Near nearest(int vertex, const Vec3& p, double limit) {
    Near near;
    double best = limit * limit;
    const auto look = [&](std::size_t i, double squared) {
      if (near.found && squared == best && i > near.triangle) return;
      const Index3& t = b_.triangles()[i];
      const PointTriangle point = closestOnTriangle(p, at(t[0]), at(t[1]), at(t[2]));
      if (pair_.self()) {
        if (!isLocalMinimum(b_, positionB_, i, point.feature, p - point.point)) return;
        if (pair_.excluded(vertex, i)) return;
      }
      near = Near{true, i, point, Vec3::Zero(), 0.0};
      best = squared;
    };
    last_ = candidates_.forEachNear(p, best, look, last_);
    if (near.found) measure(p, near);
    return near;
  }

 private:
  [[nodiscard]] const Vec3& at(int node) const { return positionB_[static_cast<std::size_t>(node)]; }

  void measure(const Vec3& p, Near& near) const {
    const Vec3 outward = pseudonormal(b_, positionB_, near.triangle, near.point.feature);
    const Vec3 away = p - near.point.point;
    const double distance = std::sqrt(near.point.squaredDistance);
    const bool inside = away.dot(outward) < 0.0;
    near.distance = inside ? -distance : distance;
    if (distance > onSurface) {
      near.normal = inside ? Vec3(-away / distance) : Vec3(away / distance);
    } else {
      const double length = outward.norm();
      near.normal = length > 1e-6 ? Vec3(outward / length) : faceNormal(b_, positionB_, near.triangle);
    }
  }

  const SurfacePair& pair_;
  const ContactSurface& a_;
  std::span<const Vec3> positionA_;
  const ContactSurface& b_;
  std::span<const Vec3> positionB_;
  Candidates candidates_;
  std::size_t last_ = 0;  ///< group of the candidates in which the last nearest point was found
  std::vector<std::uint32_t> kept_;
  std::span<const std::uint32_t> near_;     ///< of the patch taken, kept or not
  std::vector<Displacement> displacement_;  ///< per patch of b, made when first asked for
};

SurfacePair::SurfacePair(const ContactSurface& vertices, std::span<const Vec3> vertexRest,
                         const ContactSurface& triangles, std::span<const Vec3> triangleRest)
    : restA_(vertexRest.begin(), vertexRest.end()),
      restB_(triangleRest.begin(), triangleRest.end()),
      triangle_(triangles.triangles()) {
  measureRest(vertices, triangles);
}

SurfacePair::SurfacePair(const ContactSurface& surface, std::span<const Vec3> rest)
    : self_(true), restA_(rest.begin(), rest.end()), restB_(rest.begin(), rest.end()), triangle_(surface.triangles()) {
  Candidates candidates(surface, rest);
  std::vector<std::vector<std::uint32_t>> lists(rest.size());
  std::vector<double> radius(rest.size(), 0.0);
  for (std::uint32_t p = 0; p < surface.patches().size(); ++p) {
    double widest = 0.0;
    for (const int node : surface.patchNodes(p)) {
      const auto v = static_cast<std::size_t>(node);
      const std::span<const int> neighbours = surface.neighbours(node);
      for (const int n : neighbours) radius[v] += (rest[static_cast<std::size_t>(n)] - rest[v]).norm();
      radius[v] *= selfMultiple / static_cast<double>(neighbours.size());
      widest = std::max(widest, radius[v]);
    }
    candidates.gather(allPatches(surface), boundsOf(surface, rest, p, widest));
    for (const int node : surface.patchNodes(p)) {
      const auto v = static_cast<std::size_t>(node);
      double limit = radius[v] * radius[v];
      candidates.forEachNear(rest[v], limit,
                             [&](std::size_t i, double) { lists[v].push_back(static_cast<std::uint32_t>(i)); });
      std::sort(lists[v].begin(), lists[v].end());
    }
  }
  excludedStart_.push_back(0);
  for (const std::vector<std::uint32_t>& list : lists) {
    excluded_.insert(excluded_.end(), list.begin(), list.end());
    excludedStart_.push_back(excluded_.size());
  }
  measureRest(surface, surface);
}

bool SurfacePair::excluded(int vertex, std::size_t triangle) const {
  if (!self_) return false;
  const auto v = static_cast<std::size_t>(vertex);
  const auto first = excluded_.begin() + static_cast<std::ptrdiff_t>(excludedStart_[v]);
  const auto last = excluded_.begin() + static_cast<std::ptrdiff_t>(excludedStart_[v + 1]);
  return std::binary_search(first, last, static_cast<std::uint32_t>(triangle)) || wasBehind(vertex, triangle);
}

bool SurfacePair::wasBehind(int vertex, std::size_t triangle) const {
  const Index3& t = triangle_[triangle];
  const Vec3& p = restA_[static_cast<std::size_t>(vertex)];
  const Vec3& a = restB_[static_cast<std::size_t>(t[0])];
  const Vec3& b = restB_[static_cast<std::size_t>(t[1])];
  const Vec3& c = restB_[static_cast<std::size_t>(t[2])];
  const Vec3 normal = (b - a).cross(c - a);
  if (!((p - a).dot(normal) < 0.0)) return false;
  const PointTriangle point = closestOnTriangle(p, a, b, c);
  if (point.squaredDistance > thickest * thickest) return false;
  // Behind in earnest, not beside on the same bent side: more than 30 degrees below the face's plane.
  return (p - point.point).dot(normal) < -0.5 * std::sqrt(point.squaredDistance * normal.squaredNorm());
}

void SurfacePair::measureRest(const ContactSurface& a, const ContactSurface& b) {
  // Between two surfaces an overlap counts however deep it is; of a surface with itself only what would be seen.
  constexpr double far = 1e3;
  offset_.assign(restA_.size(), 0.0);
  vertexDistance_.assign(restA_.size(), known);
  patchesB_ = b.patches().size();
  patchDistance_.assign(a.patches().size() * patchesB_, known);
  SurfaceSearch whole(*this, a, restA_, b, restB_);
  whole.take(Box{Vec3::Constant(-1e300), Vec3::Constant(1e300)});
  SurfaceSearch search(*this, a, restA_, b, restB_);
  Candidates candidates(b, restB_);
  for (std::uint32_t p = 0; p < a.patches().size(); ++p) {
    double depth = deepestOverlap;
    const std::span<double> row{patchDistance_.data() + p * patchesB_, patchesB_};
    const Box box = boundsOf(a, restA_, p, known);
    candidates.gather(allPatches(b), box);
    search.take(box);
    for (const int v : a.patchNodes(p)) {
      const auto i = static_cast<std::size_t>(v);
      Near near = search.nearest(v, restA_[i], self_ ? deepestOverlap : known);
      if (!near.found && !self_) near = whole.nearest(v, restA_[i], far);
      if (near.found) offset_[i] = std::min(0.0, near.distance);
      depth = std::max(depth, deepestOverlap - offset_[i]);
      double limit = known * known;
      candidates.forEachNear(restA_[i], limit, [&](std::size_t t, double squared) {
        double& least = row[b.patchOf(t)];
        const double distance = std::sqrt(squared);
        if ((distance >= least && distance >= vertexDistance_[i]) || excluded(v, t)) return;
        least = std::min(least, distance);
        vertexDistance_[i] = std::min(vertexDistance_[i], distance);
      });
    }
    depth_.push_back(depth);
  }
}

void patchesInPlay(const SurfacePair& pair, const ContactSurface& a, std::span<const Vec3> positionA,
                   const ContactSurface& b, std::span<const Vec3> positionB, double reach,
                   std::vector<std::uint32_t>& out) {
  out.clear();
  const Displacement other = displacementOf(b.nodes(), positionB, pair.restB_);
  for (std::uint32_t p = 0; p < a.patches().size(); ++p) {
    const auto row = pair.patchDistance_.begin() + static_cast<std::ptrdiff_t>(p * pair.patchesB_);
    const double least = *std::min_element(row, row + static_cast<std::ptrdiff_t>(pair.patchesB_));
    const Displacement mine = displacementOf(a.patchNodes(p), positionA, pair.restA_);
    const double free = least - ((mine.mean - other.mean).norm() + mine.spread + other.spread);
    if (pair.depth_[p] > deepestOverlap || free <= reach) out.push_back(p);
  }
}

void surfaceContacts(const SurfacePair& pair, const ContactSurface& a, std::span<const Vec3> positionA,
                     const ContactSurface& b, std::span<const Vec3> positionB, std::span<const BroadPhase::Pair> pairs,
                     double reach, std::vector<VertexContact>& out) {
  if (pairs.empty()) return;
  SurfaceSearch search(pair, a, positionA, b, positionB);
  std::vector<std::uint32_t> patches;
  for (std::size_t first = 0; first < pairs.size();) {
    const std::uint32_t query = pairs[first].query;
    patches.clear();
    for (; first < pairs.size() && pairs[first].query == query; ++first) patches.push_back(pairs[first].leaf);
    if (!search.take(query, patches, reach)) continue;
    const std::size_t start = out.size();
    for (const int v : a.patchNodes(query)) {
      const auto i = static_cast<std::size_t>(v);
      if (search.surelyFar(i, reach)) continue;
      const double offset = pair.restOffset()[i];
      const Near near = search.nearest(v, positionA[i], std::max(reach, deepestOverlap - offset));
      if (!near.found) continue;
      const double gap = near.distance - offset;
      if (!(gap < reach) || gap < -deepestOverlap || !(near.normal.squaredNorm() > 0.5)) continue;
      const Index3& t = b.triangles()[near.triangle];
      const std::uint64_t key = (static_cast<std::uint64_t>(query) << 20U) | b.patchOf(near.triangle);
      out.push_back({v, {t[0], t[1], t[2]}, near.point.barycentric, near.normal, gap, key});
    }
    const auto from = out.begin() + static_cast<std::ptrdiff_t>(start);
    std::sort(from, out.end(), [](const VertexContact& x, const VertexContact& y) {
      if (x.key != y.key) return x.key < y.key;
      return x.gap != y.gap ? x.gap < y.gap : x.vertex < y.vertex;
    });
    out.erase(
        std::unique(from, out.end(), [](const VertexContact& x, const VertexContact& y) { return x.key == y.key; }),
        out.end());
  }
}

}  // namespace calot
