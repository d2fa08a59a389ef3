// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/near_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "sim/contact/float_bounds.h"
#include "sim/contact/rigid_motion.h"
#include "sim/contact/triangle_lanes.h"
#include "sim/math/vectors.h"

namespace calot {

namespace {

constexpr std::uint32_t everyLane = (1U << static_cast<unsigned>(laneCount)) - 1U;
constexpr std::size_t fewest = 3;    ///< triangles that are worth the lanes
constexpr double rounding = 1e-8;    // m, far above that of all distances here
constexpr double fastest = 0.00075;  ///< displacement a step beyond which lists do not live long enough to pay (m)
constexpr double turned = 0.0005;    ///< displacement from which on a common rotation is looked for (m)
constexpr std::size_t sampled = 8;   ///< vertices that the rotation is told from, about, besides a corner of each patch
constexpr std::uint64_t turns = 3;   ///< in so many steps each patch's list may be made to live

/// Widens a box to hold the motions of some nodes. @param now of each node, was of each in `node`: four numbers
/// @param rigid a motion that does not count: columns of its rotation and what it adds, four times four numbers; null:
/// none
CALOT_INLINE void include(std::span<const int> node, const double* now, const double* was, const double* rigid,
                          double* lower, double* upper) {
  FourDoubles low;
  FourDoubles high;
  FourDoubles column[4];
  readVector(lower, low);
  readVector(upper, high);
  for (std::size_t c = 0; rigid != nullptr && c < 4; ++c) readVector(rigid + 4 * c, column[c]);
  for (std::size_t k = 0; k < node.size(); ++k) {
    FourDoubles moved;
    FourDoubles before;
    readVector(now + 4 * static_cast<std::size_t>(node[k]), moved);
    const double* x = was + 4 * k;
    readVector(x, before);
    if (rigid != nullptr) before = ((column[0] * x[0] + column[1] * x[1]) + column[2] * x[2]) + column[3];
    moved -= before;
    low = moved < low ? moved : low;
    high = moved > high ? moved : high;
  }
  writeVector(low, lower);
  writeVector(high, upper);
}

CALOT_LANE_KERNEL void includeMotions(std::span<const int> node, const double* now, const double* was, double* lower,
                                      double* upper) {
  include(node, now, was, nullptr, lower, upper);
}

CALOT_LANE_KERNEL void includeTurnedMotions(std::span<const int> node, const double* now, const double* was,
                                            const double* rigid, double* lower, double* upper) {
  include(node, now, was, rigid, lower, upper);
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
  was_.clear();
  auto known = list.patch.begin();
  for (const std::uint32_t q : near) {
    known = std::lower_bound(known, list.patch.end(), q);
    if (known == list.patch.end() || *known != q) return false;
    was_.push_back(list.corner.data() + list.start[static_cast<std::size_t>(known - list.patch.begin())]);
  }
  double farthest = list.turning ? 0.0 : measure(search, patch, near, nullptr);
  list.turning = list.turning || farthest > turned;
  if (list.turning) farthest = measureTurned(search, patch, near);
  list.pace = farthest / static_cast<double>(age_ - list.age);
  return farthest + rounding < list.margin;
}

/// Works out `displaced_`, less a rigid motion where there is one: it changes no distance. @return the largest
double NearTriangles::measure(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near,
                              const std::array<Padded, 4>* rigid) {
  Padded lower;  // of a box that holds the displacements of all corners near
  Padded upper;
  lower.fill(1e300);
  upper.fill(-1e300);
  for (std::size_t i = 0; i < near.size(); ++i) {
    const std::span<const int> corner = search.b().patchCorners(near[i]);
    const double* now = now_.data()->data();
    if (rigid == nullptr) {
      includeMotions(corner, now, was_[i]->data(), lower.data(), upper.data());
    } else {
      includeTurnedMotions(corner, now, was_[i]->data(), (*rigid)[0].data(), lower.data(), upper.data());
    }
  }
  const Box moved{Vec3(lower[0], lower[1], lower[2]), Vec3(upper[0], upper[1], upper[2])};
  const std::span<const int> node = search.a().patchNodes(patch);
  displaced_.resize(node.size());
  double farthest = 0.0;
  for (const std::size_t k : search.room().open) {
    Vec3 was = list_[patch].vertex[k];
    if (rigid != nullptr) {
      const auto column = [&](std::size_t c) { return Vec3((*rigid)[c][0], (*rigid)[c][1], (*rigid)[c][2]); };
      was = ((column(0) * was[0] + column(1) * was[1]) + column(2) * was[2]) + column(3);
    }
    const Vec3 mine = search.positionA()[static_cast<std::size_t>(node[k])] - was;
    displaced_[k] = (mine - moved.lower).cwiseMax(moved.upper - mine).norm() + rounding;
    farthest = std::max(farthest, displaced_[k]);
  }
  return farthest;
}

/// Tissue that is swung about turns more than it is strained: the same less the rotation that all near have in common.
double NearTriangles::measureTurned(const SurfaceSearch& search, std::uint32_t patch,
                                    std::span<const std::uint32_t> near) {
  sampleWas_.clear();
  sampleNow_.clear();
  for (std::size_t i = 0; i < near.size(); ++i) {
    const std::span<const int> corner = search.b().patchCorners(near[i]);
    const Padded& was = was_[i][corner.size() / 2];
    sampleWas_.emplace_back(was[0], was[1], was[2]);
    sampleNow_.push_back(search.positionB()[static_cast<std::size_t>(corner[corner.size() / 2])]);
  }
  const std::span<const int> node = search.a().patchNodes(patch);
  const std::vector<std::size_t>& open = search.room().open;
  for (std::size_t i = 0; i < open.size(); i += 1 + open.size() / sampled) {
    sampleWas_.push_back(list_[patch].vertex[open[i]]);
    sampleNow_.push_back(search.positionA()[static_cast<std::size_t>(node[open[i]])]);
  }
  const RigidMotion motion(sampleWas_, sampleNow_);
  std::array<Padded, 4> rigid{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t c = 0; c < 3; ++c) rigid[c][i] = motion.rotation(static_cast<int>(i), static_cast<int>(c));
    rigid[3][i] = motion.shift[static_cast<int>(i)];
  }
  return measure(search, patch, near, &rigid);
}

void NearTriangles::readBounds(const SurfaceSearch& search) {
  bounds_.resize(search.b().patches().size());
  for (std::uint32_t q = 0; q < bounds_.size(); ++q) {
    Box box;
    for (const int n : search.b().patchCorners(q)) box.include(search.positionB()[static_cast<std::size_t>(n)]);
    bounds_[q] = box;
  }
}

void NearTriangles::precompute(const SurfacePair& pair, const ContactSurface& surface) {
  if (!pair.self()) return;
  for (std::uint32_t p = 0; p < surface.patches().size(); ++p) {
    for (std::uint32_t q = 0; q < surface.patches().size(); ++q) count(pair, surface, p, q);
  }
}

/// Works out which triangles of a patch are ever held against the vertices of another, where that is not known yet.
void NearTriangles::count(const SurfacePair& pair, const ContactSurface& surface, std::uint32_t vertices,
                          std::uint32_t triangles) {
  const std::size_t patches = surface.patches().size();
  countingStart_.resize(patches * patches, unknown);
  std::size_t& start = countingStart_[vertices * patches + triangles];
  if (start != unknown) return;
  start = counting_.size();
  const std::span<const int> node = surface.patchNodes(vertices);
  counting_.resize(start + node.size() * PatchTriangles::groups, 0);
  const ContactSurface::Patch& of = surface.patches()[triangles];
  for (std::size_t g = 0; g < laneGroups(of.last - of.first); ++g) {
    const std::size_t first = of.first + g * laneCount;
    const std::size_t some = std::min<std::size_t>(laneCount, of.last - first);
    std::array<std::uint32_t, laneCount> triangle{};
    std::iota(triangle.begin(), triangle.end(), static_cast<std::uint32_t>(first));
    TriangleLanes rest;
    gatherTriangles(surface, pair.triangleRest(), {triangle.data(), some}, rest);
    for (std::size_t k = 0; k < node.size(); ++k) {
      counting_[start + k * PatchTriangles::groups + g] =
          static_cast<std::uint8_t>(pair.notExcluded(node[k], first, some, rest));
    }
  }
}

void NearTriangles::renew(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near,
                          double reach) {
  if (bounds_.empty()) readBounds(search);
  ++counts_.renewed;
  List& list = list_[patch];
  list.made = true;
  list.reach = reach;
  list.age = age_;
  list.turning = false;
  list.margin = list.pace > fastest || (age_ + patch) % turns != 0 ? 0.0 : margin;
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
  const bool self = search.pair().self();
  for (const std::uint32_t q : list.patch) {
    if (self) count(search.pair(), search.b(), patch, q);
  }
  const std::size_t* start = self ? countingStart_.data() + patch * bounds_.size() : nullptr;
  const std::span<const int> node = search.a().patchNodes(patch);
  list.vertex.clear();
  list.entry.clear();
  list.entryEnd.clear();
  for (std::size_t k = 0; k < node.size(); ++k) {
    const auto v = static_cast<std::size_t>(node[k]);
    const Vec3& p = search.positionA()[v];
    const std::size_t first = list.entry.size();
    triangles_.forEachWithin(
        p, search.limitOf(v, reach) + list.margin,
        [&](std::uint32_t q, std::size_t g) {
          return self ? std::uint32_t{counting_[start[q] + k * PatchTriangles::groups + g]} : everyLane;
        },
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
