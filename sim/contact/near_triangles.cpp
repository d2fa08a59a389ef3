// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/near_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/contact/float_bounds.h"
#include "sim/contact/triangle_lanes.h"
#include "sim/math/vectors.h"

namespace calot {

namespace {

constexpr std::size_t fewest = 3;    ///< triangles that are worth the lanes
constexpr double rounding = 1e-8;    // m, far above that of all distances here
constexpr double fastest = 0.00075;  ///< displacement a step beyond which lists do not live long enough to pay (m)

/// Widens a box to hold the motions of some nodes. @param now of each node, was of each in `node`: four numbers
CALOT_LANE_KERNEL void includeMotions(std::span<const int> node, const double* now, const double* was, double* lower,
                                      double* upper) {
  FourDoubles low;
  FourDoubles high;
  readVector(lower, low);
  readVector(upper, high);
  for (std::size_t k = 0; k < node.size(); ++k) {
    FourDoubles moved;
    FourDoubles before;
    readVector(now + 4 * static_cast<std::size_t>(node[k]), moved);
    readVector(was + 4 * k, before);
    moved -= before;
    low = moved < low ? moved : low;
    high = moved > high ? moved : high;
  }
  writeVector(low, lower);
  writeVector(high, upper);
}

}  // namespace

void NearTriangles::reset() {
  for (List& list : list_) list.made = false;
  counts_ = {};
}

void NearTriangles::begin(const SurfaceSearch& search) {
  ++age_;
  list_.resize(search.a().patches().size());
  bounds_.clear();
  now_.resize(search.positionB().size());
  for (std::size_t n = 0; n < now_.size(); ++n) {
    const Vec3& p = search.positionB()[n];
    now_[n] = {p[0], p[1], p[2], 0.0};
  }
  triangles_.begin(search.b(), search.positionB());
}

void NearTriangles::follow(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near,
                           double reach) {
  patch_ = patch;
  if (!holds(search, patch, near, reach)) renew(search, patch, near, reach);
}

/// Have the open vertices been displaced by less than the margin against all triangles near them?
bool NearTriangles::holds(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near,
                          double reach) {
  List& list = list_[patch];
  if (!list.made || list.reach != reach) return false;
  Padded lower;  // of a box that holds the displacements of all corners near
  Padded upper;
  lower.fill(1e300);
  upper.fill(-1e300);
  auto known = list.patch.begin();
  for (const std::uint32_t q : near) {
    known = std::lower_bound(known, list.patch.end(), q);
    if (known == list.patch.end() || *known != q) return false;
    const Padded* was = list.corner.data() + list.start[static_cast<std::size_t>(known - list.patch.begin())];
    includeMotions(search.b().patchCorners(q), now_.data()->data(), was->data(), lower.data(), upper.data());
  }
  const Box moved{Vec3(lower[0], lower[1], lower[2]), Vec3(upper[0], upper[1], upper[2])};
  const std::span<const int> node = search.a().patchNodes(patch);
  displaced_.resize(node.size());
  double farthest = 0.0;
  for (const std::size_t k : search.room().open) {
    const Vec3 mine = search.positionA()[static_cast<std::size_t>(node[k])] - list.vertex[k];
    displaced_[k] = (mine - moved.lower).cwiseMax(moved.upper - mine).norm() + rounding;
    farthest = std::max(farthest, displaced_[k]);
  }
  list.pace = farthest / static_cast<double>(age_ - list.age);
  return farthest + rounding < list.margin;
}

void NearTriangles::readBounds(const SurfaceSearch& search) {
  bounds_.resize(search.b().patches().size());
  for (std::uint32_t q = 0; q < bounds_.size(); ++q) {
    Box box;
    for (const int n : search.b().patchCorners(q)) box.include(search.positionB()[static_cast<std::size_t>(n)]);
    bounds_[q] = box;
  }
}

/// Which of eight triangles of a patch are ever held against the vertex, a bit for each.
std::uint32_t NearTriangles::counting(const SurfaceSearch& search, int vertex, std::uint32_t patch, std::size_t group) {
  const ContactSurface::Patch& of = search.b().patches()[patch];
  const std::size_t first = of.first + group * laneCount;
  const std::size_t count = std::min<std::size_t>(laneCount, of.last - first);
  if (!search.pair().self()) return (1U << count) - 1U;
  if (counting_.empty()) counting_.resize(search.positionA().size());
  std::vector<Counting>& own = counting_[static_cast<std::size_t>(vertex)];
  if (own.empty()) own.resize(search.b().patches().size() * PatchTriangles::groups);
  Counting& known = own[patch * PatchTriangles::groups + group];
  if (!known.known) {
    known.known = true;
    for (std::size_t l = 0; l < count; ++l) {
      if (!search.pair().excluded(vertex, first + l)) known.lanes |= static_cast<std::uint8_t>(1U << l);
    }
  }
  return known.lanes;
}

void NearTriangles::renew(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near,
                          double reach) {
  if (bounds_.empty()) readBounds(search);
  ++counts_.renewed;
  List& list = list_[patch];
  list.made = true;
  list.reach = reach;
  list.age = age_;
  list.margin = list.pace > fastest ? 0.0 : margin;
  const Box box =
      boundsOf(search.a(), search.positionA(), patch, search.pair().search(patch, reach) + list.margin + rounding);
  list.patch.clear();
  list.start.assign(1, 0);
  list.corner.clear();
  for (std::uint32_t q = 0; q < bounds_.size(); ++q) {
    if (!bounds_[q].overlaps(box) && !std::binary_search(near.begin(), near.end(), q)) continue;
    list.patch.push_back(q);
    for (const int n : search.b().patchCorners(q)) list.corner.push_back(now_[static_cast<std::size_t>(n)]);
    list.start.push_back(list.corner.size());
  }
  triangles_.choose(list.patch, box);
  const std::span<const int> node = search.a().patchNodes(patch);
  list.vertex.clear();
  list.entry.clear();
  list.entryEnd.clear();
  for (const int n : node) {
    const auto v = static_cast<std::size_t>(n);
    const Vec3& p = search.positionA()[v];
    const std::size_t first = list.entry.size();
    triangles_.forEachWithin(
        p, search.limitOf(v, reach) + list.margin,
        [&](std::uint32_t q, std::size_t g) { return counting(search, n, q, g); },
        [&](std::size_t t, double squared) {
          list.entry.push_back({floatBelow(std::sqrt(squared) - rounding), static_cast<std::uint32_t>(t)});
        });
    std::sort(list.entry.begin() + static_cast<std::ptrdiff_t>(first), list.entry.end());
    list.entryEnd.push_back(list.entry.size());
    list.vertex.push_back(p);
  }
  displaced_.assign(node.size(), rounding);
}

Near NearTriangles::nearest(const SurfaceSearch& search, std::size_t place, double reach) {
  const List& list = list_[patch_];
  const int vertex = search.a().patchNodes(patch_)[place];
  const Vec3& p = search.positionA()[static_cast<std::size_t>(vertex)];
  const double limit = search.limitOf(static_cast<std::size_t>(vertex), reach);
  Near near;
  double best = limit * limit;
  double farthest =
      limit + displaced_[place] + rounding;  // that an entry can have been, to be no farther than best now
  std::size_t looked = 0;
  const auto offer = [&](std::uint32_t triangle) {
    const double before = best;
    search.offer(p, triangle, near, best);
    if (best < before) farthest = std::sqrt(best) + displaced_[place] + rounding;
  };
  const std::size_t end = list.entryEnd[place];
  for (std::size_t e = place == 0 ? 0 : list.entryEnd[place - 1]; e < end;) {
    // The nearest two by themselves: most often one of them it is. Lanes tell which of the others can be nearer.
    const std::size_t most = std::min(end - e, looked < 2 ? std::size_t{1} : std::size_t{laneCount});
    std::array<std::uint32_t, laneCount> triangle{};
    std::size_t count = 0;
    while (count < most && static_cast<double>(list.entry[e + count].distance) <= farthest) {
      triangle[count] = list.entry[e + count].triangle;
      ++count;
    }
    if (count == 0) break;
    looked += count;
    e += count;
    LaneValues squared{};
    if (count >= fewest) {
      TriangleLanes lanes;
      gatherTriangles(search.b(), search.positionB(), {triangle.data(), count}, lanes);
      pointTriangleDistances(lanes, p, squared);
    }
    for (std::size_t l = 0; l < count; ++l) {
      if (squared[l] <= best) offer(triangle[l]);
    }
  }
  counts_.looked += looked;
  counts_.searched += looked > 0 ? 1 : 0;
  if (near.found) search.measure(p, near);
  return near;
}

}  // namespace calot
