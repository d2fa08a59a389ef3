// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/surfaces/surface_parts.h"

#include <fmt/format.h>
#include <algorithm>
#include <optional>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/surfaces/surface_stitching.h"
#include "recorder/surfaces/surface_union.h"
#include "sim/geometry/surface_distance.h"

namespace calot::recorder {
namespace {

void reverse(SurfacePart& part) {
  for (Index3& t : part.mesh.triangle) std::swap(t[1], t[2]);
  part.turned = part.mesh.triangles() - part.turned;
}

/// Outward; repaired where edges are not sound.
void mendPart(SurfacePart& part, SurfaceRepair& sum) {
  part.inward = signedVolume(part.mesh) < 0.0;
  if (hasSoundEdges(part.mesh) && inspectSurface(part.mesh).degenerateTriangles == 0) {
    if (part.inward) reverse(part);
    return;
  }
  SurfaceRepair repair = repairSurface(part.mesh);
  part.turned = repair.flippedTriangles;
  sum.weldedVertices += repair.weldedVertices;
  sum.droppedDegenerate += repair.droppedDegenerate;
  sum.droppedDuplicates += repair.droppedDuplicates;
  sum.droppedVertices += repair.droppedVertices;
  part.mesh = std::move(repair.mesh);
}

/// A closed part and what asks where points are.
class Body {
 public:
  explicit Body(const SurfacePart& part) : part_(&part), box_(bounds(part.mesh)) {}

  [[nodiscard]] const Box& box() const { return box_; }
  [[nodiscard]] const TriangleMesh& mesh() const { return part_->mesh; }

  struct Share {
    bool inside = false, outside = false;
  };

  /// On which side of this surface vertices and middles of triangles of another part lie; those on it are on none.
  [[nodiscard]] Share shareInside(const Body& other) {
    constexpr int samples = 200;
    if (!distance_) distance_.emplace(mesh(), InsideRule::winding);
    const double tolerance = 1e-9 * (box_.upper - box_.lower).norm();
    Share share;
    const auto ask = [&](const Vec3& p) {
      const double d = distance_->signedDistance(p);
      share.inside = share.inside || d < -tolerance;
      share.outside = share.outside || d > tolerance;
    };
    for (int v = 0; v < other.mesh().vertices(); v += other.mesh().vertices() / samples + 1)
      ask(other.mesh().vertex[slot(v)]);
    for (int t = 0; t < other.mesh().triangles(); t += other.mesh().triangles() / samples + 1)
      ask((other.mesh().corner(t, 0) + other.mesh().corner(t, 1) + other.mesh().corner(t, 2)) / 3.0);
    return share;
  }

 private:
  const SurfacePart* part_;
  Box box_;
  std::optional<SurfaceDistance> distance_;
};

bool meet(const Box& a, const Box& b) {
  return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

/// Do triangles of one pass through triangles of the other?
bool cross(const Body& a, const Body& b) {
  TriangleMesh both = a.mesh();
  both.vertex.insert(both.vertex.end(), b.mesh().vertex.begin(), b.mesh().vertex.end());
  both.triangle.clear();
  const auto add = [&](const Body& from, const Box& near, int shift) {
    for (int t = 0; t < from.mesh().triangles(); ++t) {
      Box box;
      for (int k = 0; k < 3; ++k) box.include(from.mesh().corner(t, k));
      if (meet(box, near)) both.triangle.emplace_back(from.mesh().triangle[slot(t)].array() + shift);
    }
  };
  add(a, b.box(), 0);
  add(b, a.box(), a.mesh().vertices());
  const auto isFirst = [&](int t) { return both.triangle[slot(t)][0] < a.mesh().vertices(); };
  // Each may cross itself: such triangles are taken away until two of different parts are found.
  for (int tries = 0; tries < 100; ++tries) {
    const SelfCrossing crossing = findSelfCrossing(both, 1);
    if (crossing.pairs == 0) return false;
    if (isFirst(crossing.first) != isFirst(crossing.second)) return true;
    both.triangle.erase(both.triangle.begin() + crossing.first);
  }
  return false;
}

/// How parts lie to each other.
struct Arrangement {
  std::vector<int> group;                ///< of parts that overlap: the first of them
  std::vector<std::vector<int>> around;  ///< parts that one lies wholly inside of
};

Arrangement arrangementOf(const std::vector<SurfacePart>& parts) {
  std::vector<Body> body(parts.begin(), parts.end());
  Arrangement found;
  found.around.resize(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) found.group.push_back(static_cast<int>(i));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!meet(body[i].box(), body[j].box())) continue;
      const Body::Share iInJ = body[j].shareInside(body[i]), jInI = body[i].shareInside(body[j]);
      const bool same = !iInJ.inside && !iInJ.outside && !jInI.inside && !jInI.outside;
      if (same || (iInJ.inside && iInJ.outside) || (jInI.inside && jInI.outside) || cross(body[i], body[j])) {
        const int from = std::max(found.group[i], found.group[j]), to = std::min(found.group[i], found.group[j]);
        std::replace(found.group.begin(), found.group.end(), from, to);
      } else if (iInJ.inside) {
        found.around[i].push_back(static_cast<int>(j));
      } else if (jInI.inside) {
        found.around[j].push_back(static_cast<int>(i));
      }
    }
  }
  return found;
}

std::string millilitres(double volume) { return fmt::format("{:.4g} mL", 1e6 * volume); }

}  // namespace

std::vector<SurfacePart> partsOf(const TriangleMesh& mesh, SurfaceRepair& repair) {
  int count = 0;
  const std::vector<int> of = triangleComponents(mesh, count);
  std::vector<SurfacePart> parts(slot(count));
  for (int t = 0; t < mesh.triangles(); ++t) parts[slot(of[slot(t)])].mesh.triangle.push_back(mesh.triangle[slot(t)]);
  std::vector<int> number(mesh.vertex.size(), -1), used;
  for (SurfacePart& part : parts) {
    used.clear();
    for (const Index3& t : part.mesh.triangle) used.insert(used.end(), t.begin(), t.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const int v : used) {
      number[slot(v)] = part.mesh.vertices();
      part.mesh.vertex.push_back(mesh.vertex[slot(v)]);
    }
    for (Index3& t : part.mesh.triangle) {
      for (int& v : t) v = number[slot(v)];
    }
    mendPart(part, repair);
  }
  return parts;
}

TriangleMesh joined(const std::vector<SurfacePart>& parts) {
  TriangleMesh whole;
  for (const SurfacePart& part : parts) {
    const int shift = whole.vertices();
    whole.vertex.insert(whole.vertex.end(), part.mesh.vertex.begin(), part.mesh.vertex.end());
    for (const Index3& t : part.mesh.triangle) whole.triangle.emplace_back(t.array() + shift);
  }
  return whole;
}

void arrangeParts(std::vector<SurfacePart>& parts, std::vector<std::string>& notes) {
  if (parts.size() < 2) return;
  // A file may have all of its triangles the wrong way round.
  double volume = 0.0;
  for (const SurfacePart& part : parts) volume += signedVolume(part.mesh) * (part.inward ? -1.0 : 1.0);
  const Arrangement lie = arrangementOf(parts);
  const auto members = [&](std::size_t g) {
    return std::count(lie.group.begin(), lie.group.end(), static_cast<int>(g));
  };
  std::vector<char> cavity(parts.size(), 0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto alone = members(slot(lie.group[i])) == 1;
    cavity[i] = alone && !lie.around[i].empty() && parts[i].inward == (volume >= 0.0) ? 1 : 0;
  }
  std::vector<SurfacePart> kept;
  int left = 0, overlapping = 0;
  double leftVolume = 0.0, before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (lie.group[i] != static_cast<int>(i)) continue;
    // How often what is around it, each group once, is solid there.
    std::vector<int> around;
    for (const int j : lie.around[i]) around.push_back(lie.group[slot(j)]);
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    int solid = 0;
    for (const int g : around) solid += cavity[slot(g)] != 0 ? -1 : 1;
    if (cavity[i] != 0 ? solid != 1 : solid > 0) {
      ++left;
      leftVolume += signedVolume(parts[i].mesh);
      continue;
    }
    if (cavity[i] != 0) reverse(parts[i]);
    const auto first = static_cast<std::ptrdiff_t>(kept.size());
    std::vector<TriangleMesh> pieces;
    double sum = 0.0;
    for (std::size_t j = i; j < parts.size(); ++j) {
      if (lie.group[j] != static_cast<int>(i)) continue;
      kept.push_back(parts[j]);
      pieces.push_back(parts[j].mesh);
      sum += signedVolume(parts[j].mesh);
    }
    if (pieces.size() == 1) continue;
    try {
      SurfacePart whole{uniteSurfaces(pieces), false, 0, true};
      for (auto part = kept.begin() + first; part != kept.end(); ++part) whole.turned += part->turned;
      kept.erase(kept.begin() + first, kept.end());
      kept.push_back(std::move(whole));
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::refused) throw;
      notes.push_back(fmt::format("{} parts overlap and were not joined: {}", pieces.size(), e.fault()));
      continue;
    }
    overlapping += static_cast<int>(pieces.size());
    before += sum;
    after += signedVolume(kept.back().mesh);
  }
  if (overlapping > 0) {
    notes.push_back(fmt::format("{} parts that overlap were joined: {} together, {} as one body", overlapping,
                                millilitres(before), millilitres(after)));
  }
  if (left > 0) {
    notes.push_back(
        fmt::format("{} parts ({}) inside others were left out, since the file turns them the same way: what is around "
                    "them is solid; a cavity has its triangles the other way round",
                    left, millilitres(leftVolume)));
  }
  parts = std::move(kept);
}

}  // namespace calot::recorder
