// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/surface_surface.h"

#include <algorithm>

#include "sim/contact/near_triangles.h"
#include "sim/contact/surface_search.h"

namespace calot {

void measureDisplacement(const ContactSurface& surface, std::span<const Vec3> position, std::span<const Vec3> rest,
                         SurfaceDisplacement& out) {
  out.whole = displacementOf(surface.nodes(), position, rest);
  out.patch.resize(surface.patches().size());
  for (std::uint32_t p = 0; p < out.patch.size(); ++p) {
    out.patch[p] = displacementOf(surface.patchNodes(p), position, rest);
  }
}

void patchesInPlay(const SurfacePair& pair, const SurfaceDisplacement& a, const SurfaceDisplacement& b, double reach,
                   std::vector<std::uint32_t>& out) {
  out.clear();
  for (std::uint32_t p = 0; p < a.patch.size(); ++p) {
    const Displacement& own = a.patch[p];
    const double free = pair.minDistance_[p] - ((own.mean - b.whole.mean).norm() + own.spread + b.whole.spread);
    if (pair.depth_[p] > maxOverlap || free <= reach) out.push_back(p);
  }
}

void surfaceContacts(const SurfacePair& pair, const ContactSurface& a, std::span<const Vec3> positionA,
                     const ContactSurface& b, std::span<const Vec3> positionB, std::span<const BroadPhase::Pair> pairs,
                     double reach, std::vector<VertexContact>& out, NearTriangles* memory) {
  if (pairs.empty()) return;
  SearchScratch own;
  SearchScratch& scratch = memory != nullptr ? memory->scratch() : own;
  SurfaceSearch search(pair, a, positionA, b, positionB, scratch);
  if (memory != nullptr) memory->begin(search);
  for (std::size_t first = 0; first < pairs.size();) {
    const std::uint32_t query = pairs[first].query;
    scratch.near.clear();
    for (; first < pairs.size() && pairs[first].query == query; ++first) scratch.near.push_back(pairs[first].leaf);
    if (!search.selectPatch(query, scratch.near, reach)) continue;
    const std::span<const int> node = a.patchNodes(query);
    scratch.open.clear();
    for (std::size_t k = 0; k < node.size(); ++k) {
      if (!search.surelyFar(static_cast<std::size_t>(node[k]), reach)) scratch.open.push_back(k);
    }
    if (scratch.open.empty()) continue;
    if (memory != nullptr) {
      memory->updateLists(search, query, scratch.near, reach);
    } else {
      search.gather();
    }
    const std::size_t start = out.size();
    for (const std::size_t k : scratch.open) {
      const int v = node[k];
      const auto i = static_cast<std::size_t>(v);
      const double offset = pair.restOffset()[i];
      const Near near = memory != nullptr ? memory->nearest(search, k, reach)
                                          : search.nearest(v, positionA[i], search.limitOf(i, reach));
      if (!near.found) continue;
      const double gap = near.distance - offset;
      if (!(gap < reach) || gap < -maxOverlap || !(near.normal.squaredNorm() > 0.5)) continue;
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
