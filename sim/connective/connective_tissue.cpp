// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/connective/connective_tissue.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "sim/geometry/isosurface_stuffing.h"

namespace calot {

namespace {

constexpr double minLength = 1e-6;  ///< m: shorter strands take their direction at rest

struct Stretch {
  Vec3 direction = Vec3::Zero();
  double length = 0.0;
};

Stretch stretchOf(const Strand& strand, const Vec3& a, const Vec3& b) {
  const Vec3 way = a - b;
  const double length = way.norm();
  if (length < minLength) return {strand.restDirection, length};
  return {way / length, length};
}

}  // namespace

ConnectiveTissue::ConnectiveTissue(std::vector<Strand> strands, std::vector<std::array<std::uint32_t, 2>> sheets,
                                   ConnectiveMaterial material)
    : strand_(std::move(strands)), sheet_(std::move(sheets)), material_(material) {
  for (const Strand& strand : strand_) area_ += strand.area;
}

void ConnectiveTissue::preload(std::span<const Vec3> displacementA, std::span<const Vec3> displacementB) {
  for (Strand& strand : strand_) {
    strand.load = stiffnessOf(strand) * (strand.b.of(displacementB) - strand.a.of(displacementA));
  }
}

ConnectiveState intactState(const ConnectiveTissue& tissue) {
  ConnectiveState state;
  state.condition.assign(tissue.strands().size(), StrandCondition::attached);
  state.alpha.assign(tissue.strands().size(), 1.0);
  state.damage.assign(tissue.strands().size(), 0.0);
  return state;
}

void linearise(const ConnectiveTissue& tissue, const ConnectiveState& state, const OrganMotion& a, const OrganMotion& b,
               double step, ConnectiveLoads& out) {
  const ConnectiveMaterial& m = tissue.material();
  const CohesiveLaw law = m.law();
  out.onA.clear();
  out.onB.clear();
  out.damper.assign(tissue.strands().size(), 0.0);
  for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
    if (state.condition[s] != StrandCondition::attached) continue;
    const Strand& strand = tissue.strands()[s];
    const Stretch stretch = stretchOf(strand, strand.a.of(a.position), strand.b.of(b.position));
    const Vec3 velocityA = strand.a.of(a.velocity);
    const Vec3 velocityB = strand.b.of(b.velocity);
    const double section = state.alpha[s] * strand.area;
    const double separation = stretch.length - strand.restLength;
    const double tension = section * law.secant(separation, state.damage[s]) * separation;
    // A strand that closes within the step may end in compression, where it is intact.
    const double ahead = separation + std::min(step * stretch.direction.dot(velocityA - velocityB), 0.0);
    const double secant = law.secant(ahead, state.damage[s]);
    const double damper = section * (step * secant + m.damping * (secant / m.stiffness));
    Vec3 force = tension * stretch.direction;
    if (!strand.load.isZero(0.0)) {
      const double left = state.alpha[s] * (1.0 - state.damage[s]);
      const Vec3 load = b.rotation.empty() ? strand.load : Vec3(rotationOf(b.rotation, strand.b.element) * strand.load);
      force -= left * load;
    }
    out.damper[s] = damper;
    Attachment& onA = out.onA.emplace_back();
    onA.point = strand.a;
    onA.damper = damper * Mat3::Identity();
    onA.force = damper * velocityB - force;
    Attachment& onB = out.onB.emplace_back();
    onB.point = strand.b;
    onB.damper = onA.damper;
    onB.force = damper * velocityA + force;
  }
}

double strandTension(const ConnectiveTissue& tissue, const ConnectiveState& state, std::size_t strand,
                     std::span<const Vec3> positionA, std::span<const Vec3> positionB) {
  if (state.condition[strand] != StrandCondition::attached) return 0.0;
  const Strand& s = tissue.strands()[strand];
  const double separation = stretchOf(s, s.a.of(positionA), s.b.of(positionB)).length - s.restLength;
  return state.alpha[strand] * s.area * tissue.material().law().secant(separation, state.damage[strand]) * separation;
}

DamageReport advanceDamage(const ConnectiveTissue& tissue, ConnectiveState& state, std::span<const Vec3> positionA,
                           std::span<const Vec3> positionB, std::vector<std::uint32_t>& torn) {
  const CohesiveLaw law = tissue.material().law();
  DamageReport report;
  for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
    if (state.condition[s] != StrandCondition::attached) continue;
    const Strand& strand = tissue.strands()[s];
    const double separation =
        stretchOf(strand, strand.a.of(positionA), strand.b.of(positionB)).length - strand.restLength;
    const double damage = law.damageAt(separation);
    if (damage > state.damage[s]) {
      state.damage[s] = damage;
      report.grown = true;
    }
    report.maxTraction = std::max(report.maxTraction, law.secant(separation, state.damage[s]) * separation);
    if (state.damage[s] < 1.0) continue;
    state.condition[s] = StrandCondition::torn;
    torn.push_back(static_cast<std::uint32_t>(s));
  }
  return report;
}

void touchStrands(const ConnectiveTissue& tissue, const ConnectiveState& state, const OrganMotion& a,
                  const OrganMotion& b, std::span<const MovingCapsule> hook, double reach, double step,
                  std::vector<StrandTouch>& touches) {
  const auto motion = [step](const MaterialPoint& point, const OrganMotion& organ) {
    const Vec3 now = point.of(organ.position);
    return MovingPoint{now - step * point.of(organ.velocity), now};
  };
  for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
    if (state.condition[s] == StrandCondition::burned) continue;
    const Strand& strand = tissue.strands()[s];
    const std::array<MovingPoint, 2> end{motion(strand.a, a), motion(strand.b, b)};
    Box box;
    for (const MovingPoint& p : end) {
      box.include(p.before);
      box.include(p.now);
    }
    StepIntervals touched;
    for (const MovingCapsule& part : hook) {
      const bool attached = state.condition[s] == StrandCondition::attached;
      const double far = attached ? reach : reach + std::max(0.5 * strand.restLength, part.radius);
      if (!box.overlaps(boundsOf(part, far))) continue;
      if (attached) {
        touched.add(near(part, end, far));
      } else {
        touched.add(near(part, end[0], far));
        touched.add(near(part, end[1], far));
      }
    }
    if (!touched.empty()) touches.push_back({static_cast<std::uint32_t>(s), touched.length()});
  }
}

void burnStrands(const ConnectiveTissue& tissue, ConnectiveState& state, std::span<const StrandTouch> touches,
                 double seconds, std::vector<std::uint32_t>& burned) {
  const ConnectiveMaterial& m = tissue.material();
  for (const StrandTouch& touch : touches) {
    const std::size_t s = touch.strand;
    state.alpha[s] -= touch.share * seconds / m.fadeTime * (1.0 - m.goneBelow);
    if (state.alpha[s] > m.goneBelow) continue;
    state.alpha[s] = 0.0;
    state.condition[s] = StrandCondition::burned;
    burned.push_back(touch.strand);
  }
}

ConnectiveShares sharesOf(const ConnectiveTissue& tissue, const ConnectiveState& state) {
  ConnectiveShares shares;
  if (!(tissue.area() > 0.0)) return shares;
  for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
    const double share = tissue.strands()[s].area;
    switch (state.condition[s]) {
      case StrandCondition::attached:
        shares.attached += share;
        break;
      case StrandCondition::burned:
        shares.burned += share;
        break;
      case StrandCondition::torn:
        shares.torn += share;
        break;
    }
  }
  // If all strands are of one kind, its share is exactly 1: sums run in the same order as the area's.
  shares.attached /= tissue.area();
  shares.burned /= tissue.area();
  shares.torn /= tissue.area();
  return shares;
}

namespace {

/// A vertex of the subdivided bed: up to three surface vertices and the number of n-ths of each; unused entries are -1.
using Blend = std::array<std::array<int, 2>, 3>;

Blend blendOf(const Index3& triangle, const std::array<int, 3>& parts) {
  Blend blend{{{-1, 0}, {-1, 0}, {-1, 0}}};
  for (int c = 0; c < 3; ++c) {
    if (parts[static_cast<std::size_t>(c)] > 0) {
      blend[static_cast<std::size_t>(c)] = {triangle[c], parts[static_cast<std::size_t>(c)]};
    }
  }
  if (blend[1] < blend[0]) std::swap(blend[0], blend[1]);
  if (blend[2] < blend[1]) std::swap(blend[1], blend[2]);
  if (blend[1] < blend[0]) std::swap(blend[0], blend[1]);
  return blend;
}

/// The triangles of a bed with every edge divided by n; vertices are numbered in order of first use.
struct Division {
  std::vector<Blend> vertex;
  std::vector<Index3> triangle;
};

Division divide(const std::vector<Index3>& bed, int n) {
  Division out;
  std::map<Blend, int> number;
  const auto at = [&](const Index3& t, int i, int j) {
    const Blend blend = blendOf(t, {n - i - j, i, j});
    const auto [found, isNew] = number.try_emplace(blend, static_cast<int>(out.vertex.size()));
    if (isNew) out.vertex.push_back(blend);
    return found->second;
  };
  for (const Index3& t : bed) {
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        // Vertices are numbered on first use: one statement each, since the order of evaluation
        // of arguments is unspecified.
        const int third = at(t, i, j + 1);
        const int second = at(t, i + 1, j);
        const int first = at(t, i, j);
        out.triangle.emplace_back(first, second, third);
        if (i + j + 1 < n) {
          const int opposite = at(t, i + 1, j + 1);
          out.triangle.emplace_back(second, opposite, third);
        }
      }
    }
  }
  return out;
}

/// Index of each element by its corners.
using ElementIndex = std::map<std::array<int, 4>, int>;

ElementIndex elementsOf(const TetrahedralMesh& mesh) {
  ElementIndex out;
  for (std::size_t e = 0; e < mesh.tetrahedron.size(); ++e) {
    const Index4& t = mesh.tetrahedron[e];
    out.emplace(std::array{t[0], t[1], t[2], t[3]}, static_cast<int>(e));
  }
  return out;
}

MaterialPoint pointOf(const Embedding::Anchor& anchor, const ElementIndex& elements) {
  MaterialPoint point;
  point.element = elements.at(anchor.node);
  point.count = 4;
  for (std::size_t k = 0; k < 4; ++k) {
    point.node[k] = anchor.node[k];
    point.weight[k] = anchor.weight[k];
  }
  return point;
}

std::vector<std::array<std::uint32_t, 2>> edgesOf(const std::vector<Index3>& triangles) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const Index3& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint32_t>(t[k]);
      const auto b = static_cast<std::uint32_t>(t[(k + 1) % 3]);
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace

std::vector<Index3> bedTriangles(const TriangleMesh& first, const SurfaceDistance& second, double reach) {
  std::vector<bool> near;
  for (const Vec3& p : first.vertex) near.push_back(second.signedDistance(p) <= reach);
  std::vector<Index3> bed;
  for (const Index3& t : first.triangle) {
    if (near[slot(t[0])] && near[slot(t[1])] && near[slot(t[2])]) bed.push_back(t);
  }
  return bed;
}

ConnectiveBed makeBed(const BedOrgan& first, const BedOrgan& second, double reach, std::size_t minStrands) {
  ConnectiveBed out;
  const SurfaceDistance distance(second.surface);
  const std::vector<Index3> bed = bedTriangles(first.surface, distance, reach);
  if (bed.empty()) {
    out.error = "no triangle of the first organ lies within " + std::to_string(1000.0 * reach) +
                " mm of the second: there is no bed for connective tissue";
    return out;
  }
  int n = 1;
  Division division = divide(bed, n);
  while (division.vertex.size() < minStrands) division = divide(bed, ++n);

  std::vector<Vec3> ends;
  std::vector<Vec3> feet;
  for (const Blend& blend : division.vertex) {
    Vec3 p = Vec3::Zero();
    for (const auto& [vertex, parts] : blend) {
      if (vertex >= 0) p += static_cast<double>(parts) / n * first.surface.vertex[slot(vertex)];
    }
    ends.push_back(p);
    feet.push_back(distance.closest(p).on.point);
  }
  const ElementIndex elementsOfFirst = elementsOf(first.mesh);
  const ElementIndex elementsOfSecond = elementsOf(second.mesh);
  const Embedding inFirst(ends, first.mesh);
  const Embedding inSecond(feet, second.mesh);
  for (std::size_t s = 0; s < ends.size(); ++s) {
    Strand strand;
    strand.a = pointOf(inFirst.anchors()[s], elementsOfFirst);
    strand.b = pointOf(inSecond.anchors()[s], elementsOfSecond);
    const Vec3 way = ends[s] - feet[s];
    strand.restLength = way.norm();
    // If organs touch or overlap at rest, strands still point out of the second one.
    const Index3& t = second.surface.triangle[slot(distance.closest(ends[s]).triangle)];
    const Vec3& a = second.surface.vertex[slot(t[0])];
    const Vec3 outward = (second.surface.vertex[slot(t[1])] - a).cross(second.surface.vertex[slot(t[2])] - a);
    strand.restDirection = strand.restLength > 1e-5 ? Vec3(way / strand.restLength) : Vec3(outward / outward.norm());
    out.strands.push_back(strand);
  }
  for (const Index3& t : division.triangle) {
    const Vec3& a = ends[slot(t[0])];
    const double third = (ends[slot(t[1])] - a).cross(ends[slot(t[2])] - a).norm() / 6.0;
    for (int k = 0; k < 3; ++k) out.strands[slot(t[k])].area += third;
  }
  out.sheets = edgesOf(division.triangle);
  return out;
}

}  // namespace calot
