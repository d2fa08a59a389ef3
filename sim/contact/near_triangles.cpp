// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/surface_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "sim/contact/broad_phase.h"
#include "sim/contact/triangle_lanes.h"
#include "sim/math/vectors.h"

namespace calot {

namespace {

constexpr std::uint32_t everyLane = (1U << static_cast<unsigned>(laneCount)) - 1U;
constexpr std::size_t minLaneTriangles = 3;  ///< below this number, scalar code is faster
constexpr double rounding = 1e-8;            // m, far above the rounding error of all distances here
constexpr double maxListSpeed = 0.00075;     ///< displacement per step above which lists expire too soon to pay off (m)
constexpr double rotationThreshold = 0.0005;  ///< displacement above which a common rotation is removed (m)
constexpr std::size_t sampled =
    8;  ///< approximate number of vertices that the rotation is fitted to, besides one corner of each patch
constexpr std::uint64_t renewalPeriod = 3;  ///< each patch may build a list with a margin once in this many steps

/// Grows a box to contain the displacements of some nodes. @param now per node, was per entry of `node`: four numbers
/// @param rigid rigid motion to subtract: three columns of its rotation and its translation, four
/// numbers each; null: none
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

CALOT_LANE_KERNEL void includeRotatedMotions(std::span<const int> node, const double* now, const double* was,
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

void NearTriangles::updateLists(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near,
                                double reach) {
  patch_ = patch;
  if (!isValid(search, patch, near, reach)) rebuild(search, patch, near, reach);
}

/// Have all open vertices moved by less than the margin relative to all triangles near them?
bool NearTriangles::isValid(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near,
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
  double farthest = list.rotating ? 0.0 : measure(search, patch, near, nullptr);
  list.rotating = list.rotating || farthest > rotationThreshold;
  if (list.rotating) farthest = measureRotated(search, patch, near);
  list.speed = farthest / static_cast<double>(age_ - list.age);
  return farthest + rounding < list.margin;
}

/// Computes `displaced_` after subtracting a rigid motion, which changes no distance. @return the maximum
double NearTriangles::measure(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near,
                              const std::array<Padded, 4>* rigid) {
  Padded lower;  // bounds of the displacements of all nearby corners
  Padded upper;
  lower.fill(1e300);
  upper.fill(-1e300);
  for (std::size_t i = 0; i < near.size(); ++i) {
    const std::span<const int> corner = search.b().patchCorners(near[i]);
    const double* now = now_.data()->data();
    if (rigid == nullptr) {
      includeMotions(corner, now, was_[i]->data(), lower.data(), upper.data());
    } else {
      includeRotatedMotions(corner, now, was_[i]->data(), (*rigid)[0].data(), lower.data(), upper.data());
    }
  }
  const Box moved{Vec3(lower[0], lower[1], lower[2]), Vec3(upper[0], upper[1], upper[2])};
  const std::span<const int> node = search.a().patchNodes(patch);
  displaced_.resize(node.size());
  double farthest = 0.0;
  for (const std::size_t k : search.scratch().open) {
    Vec3 was = list_[patch].vertex[k];
    if (rigid != nullptr) {
      const auto column = [&](std::size_t c) { return Vec3((*rigid)[c][0], (*rigid)[c][1], (*rigid)[c][2]); };
      was = ((column(0) * was[0] + column(1) * was[1]) + column(2) * was[2]) + column(3);
    }
    const Vec3 own = search.positionA()[static_cast<std::size_t>(node[k])] - was;
    displaced_[k] = (own - moved.lower).cwiseMax(moved.upper - own).norm() + rounding;
    farthest = std::max(farthest, displaced_[k]);
  }
  return farthest;
}

/// Tissue that is swung about rotates more than it is strained: measures displacements relative to
/// the common rigid motion.
double NearTriangles::measureRotated(const SurfaceSearch& search, std::uint32_t patch,
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
  const std::vector<std::size_t>& open = search.scratch().open;
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

/// Computes, once per pair of patches, which triangles are ever tested against which vertices.
void NearTriangles::count(const SurfacePair& pair, const ContactSurface& surface, std::uint32_t vertices,
                          std::uint32_t triangles) {
  const std::size_t patches = surface.patches().size();
  includedStart_.resize(patches * patches, unknown);
  std::size_t& start = includedStart_[vertices * patches + triangles];
  if (start != unknown) return;
  start = included_.size();
  const std::span<const int> node = surface.patchNodes(vertices);
  included_.resize(start + node.size() * PatchTriangles::groups, 0);
  const ContactSurface::Patch& of = surface.patches()[triangles];
  for (std::size_t g = 0; g < laneGroups(of.last - of.first); ++g) {
    const std::size_t first = of.first + g * laneCount;
    const std::size_t some = std::min<std::size_t>(laneCount, of.last - first);
    std::array<std::uint32_t, laneCount> triangle{};
    std::iota(triangle.begin(), triangle.end(), static_cast<std::uint32_t>(first));
    TriangleLanes rest;
    gatherTriangles(surface, pair.triangleRest(), {triangle.data(), some}, rest);
    for (std::size_t k = 0; k < node.size(); ++k) {
      included_[start + k * PatchTriangles::groups + g] =
          static_cast<std::uint8_t>(pair.notExcluded(node[k], first, some, rest));
    }
  }
}

void NearTriangles::rebuild(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near,
                            double reach) {
  if (bounds_.empty()) readBounds(search);
  ++counts_.rebuilt;
  List& list = list_[patch];
  list.made = true;
  list.reach = reach;
  list.age = age_;
  list.rotating = false;
  list.margin = list.speed > maxListSpeed || (age_ + patch) % renewalPeriod != 0 ? 0.0 : margin;
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
  const std::size_t* start = self ? includedStart_.data() + patch * bounds_.size() : nullptr;
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
          return self ? std::uint32_t{included_[start[q] + k * PatchTriangles::groups + g]} : everyLane;
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

Near NearTriangles::nearest(const SurfaceSearch& search, std::size_t index, double reach) {
  const List& list = list_[patch_];
  const int vertex = search.a().patchNodes(patch_)[index];
  const Vec3& p = search.positionA()[static_cast<std::size_t>(vertex)];
  const double limit = search.limitOf(static_cast<std::size_t>(vertex), reach);
  Near near;
  double best = limit * limit;
  double farthest = limit + displaced_[index] +
                    rounding;  // stored distance above which an entry cannot be nearer than the best so far
  std::size_t tested = 0;
  const auto offer = [&](std::uint32_t triangle) {
    const double before = best;
    search.offer(p, triangle, near, best);
    if (best < before) farthest = std::sqrt(best) + displaced_[index] + rounding;
  };
  const std::size_t end = list.entryEnd[index];
  for (std::size_t e = index == 0 ? 0 : list.entryEnd[index - 1]; e < end;) {
    // Test the nearest two one at a time: one of them is usually the result. Lanes then exclude most of the others.
    const std::size_t batch = std::min(end - e, tested < 2 ? std::size_t{1} : std::size_t{laneCount});
    std::array<std::uint32_t, laneCount> triangle{};
    std::size_t count = 0;
    while (count < batch && static_cast<double>(list.entry[e + count].distance) <= farthest) {
      triangle[count] = list.entry[e + count].triangle;
      ++count;
    }
    if (count == 0) break;
    tested += count;
    e += count;
    LaneValues squared{};
    if (count >= minLaneTriangles) {
      TriangleLanes lanes;
      gatherTriangles(search.b(), search.positionB(), {triangle.data(), count}, lanes);
      pointTriangleDistances(lanes, p, squared);
    }
    for (std::size_t l = 0; l < count; ++l) {
      if (squared[l] <= best) offer(triangle[l]);
    }
  }
  counts_.tested += tested;
  counts_.searched += tested > 0 ? 1 : 0;
  if (near.found) search.measure(p, near);
  return near;
}

}  // namespace calot
