// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/sim/carving/support/carving_bodies.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sim/math/elementary.h"

namespace calot::test {
namespace {

Vec3 randomPoint(Random& random, const Box& box) {
  const double x = random.uniform(box.lower[0], box.upper[0]);
  const double y = random.uniform(box.lower[1], box.upper[1]);
  const double z = random.uniform(box.lower[2], box.upper[2]);
  return {x, y, z};
}

Vec3 randomDirection(Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  const double z = random.normal();
  return Vec3(x, y, z).normalized();
}

}  // namespace

FieldModel fieldOf(const BrickLattice& lattice, double bandCells, const std::function<double(const Vec3&)>& distance) {
  FieldModel model;
  model.lattice = lattice;
  model.band = bandCells * lattice.cell();
  model.value.assign(lattice.storage(), model.band);
  Index3 n;
  for (n[2] = 1; n[2] + 1 < lattice.nodes()[2]; ++n[2]) {
    for (n[1] = 1; n[1] + 1 < lattice.nodes()[1]; ++n[1]) {
      for (n[0] = 1; n[0] + 1 < lattice.nodes()[0]; ++n[0]) {
        model.value[lattice.node(n)] = std::clamp(distance(lattice.position(n)), -model.band, model.band);
      }
    }
  }
  return model;
}

double slabDistance(const Vec3& p) { return (p.cwiseAbs() - Vec3(0.020, 0.015, 0.008)).maxCoeff(); }

bool insideSlab(const Vec3& p) { return slabDistance(p) < 0.0; }

std::vector<SweptCapsule> slabStroke(Random& random) {
  return {randomSweep(random, {{-0.020, -0.015, -0.004}, {0.020, 0.015, 0.008}}, 0.0015, 0.003, 0.004)};
}

FieldModel lump(int nodes, double bandCells) {
  const BrickLattice lattice(Vec3::Constant(-0.024), 0.048 / (nodes - 1), Index3::Constant(nodes));
  return fieldOf(lattice, bandCells, [](const Vec3& p) {
    const Vec3 half(0.020, 0.015, 0.008);
    const Vec3 q = p.cwiseAbs() - half + Vec3::Constant(0.004);
    const double wave = 0.0012 * sine(700.0 * p[0]) * sine(560.0 * p[1]);
    return q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff()) - 0.004 + wave;
  });
}

FieldModel noise(Random& random, int nodes) {
  const BrickLattice lattice(Vec3::Zero(), 1.0, Index3::Constant(nodes));
  const double share = random.uniform(0.3, 0.9);
  return fieldOf(lattice, 1.0,
                 [&](const Vec3&) { return random.uniform() < share ? -random.uniform(1e-9, 1.0) : random.uniform(); });
}

std::vector<std::uint32_t> floorAnchors(const BrickLattice& lattice) {
  std::vector<std::uint32_t> anchors;
  Index3 n;
  for (n[2] = 0; n[2] < 2 * lattice.nodes()[2] / 5; ++n[2]) {
    for (n[1] = 0; n[1] < lattice.nodes()[1]; ++n[1]) {
      for (n[0] = 0; n[0] < lattice.nodes()[0]; ++n[0]) anchors.push_back(lattice.node(n));
    }
  }
  return anchors;
}

SweptCapsule randomSweep(Random& random, const Box& box, double radius, double segment, double length) {
  SweptCapsule c;
  c.radius = radius;
  c.p0 = randomPoint(random, box);
  const Vec3 axis = randomDirection(random);
  c.p1 = c.p0 + segment * axis;
  c.q0 = c.p0 + length * randomDirection(random);
  c.q1 = c.q0 + segment * (axis + 0.3 * randomDirection(random)).normalized();
  return c;
}

void carveAtRest(CarvedField& field, const std::vector<SweptCapsule>& tool) {
  const double depth = carveDepth * field.lattice().cell();
  const std::vector<NodeBox> boxes{nodesWithin(field.lattice(), sweptBounds(tool, depth, 1.0))};
  carve(field, tool, boxes, UndeformedTissue(field.lattice()), depth);
}

TriangleMesh meshOf(const CarvedField& field, const CarvedSurface& surface) {
  std::vector<std::uint32_t> name;
  forEachPatch(surface, [&](const SurfacePatch& p) {
    name.insert(name.end(), p.vertex.begin(), p.vertex.begin() + p.vertexCount);
  });
  std::sort(name.begin(), name.end());
  name.erase(std::unique(name.begin(), name.end()), name.end());
  TriangleMesh mesh;
  for (const std::uint32_t v : name) mesh.vertex.push_back(surface_vertex::restPosition(field, v));
  forEachPatch(surface, [&](const SurfacePatch& p) {
    for (std::size_t t = 0; t < p.triangleCount; ++t) {
      Index3 v;
      for (int k = 0; k < 3; ++k) {
        const auto at = std::lower_bound(name.begin(), name.end(), p.vertexOf(t, slot(k)));
        v[k] = static_cast<int>(at - name.begin());
      }
      mesh.triangle.push_back(v);
    }
  });
  return mesh;
}

EdgeFaults edgeFaults(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> side;  // edge, 2 * triangle + direction
  side.reserve(3 * mesh.triangle.size());
  for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto from = static_cast<std::uint64_t>(mesh.triangle[t][k]);
      const auto to = static_cast<std::uint64_t>(mesh.triangle[t][(k + 1) % 3]);
      side.push_back(
          {std::min(from, to) << 32U | std::max(from, to), static_cast<std::uint32_t>(2 * t + (from < to ? 1 : 0))});
    }
  }
  std::sort(side.begin(), side.end());
  EdgeFaults faults;
  std::vector<int> neighbours(mesh.triangle.size(), 0);
  for (std::size_t i = 0; i < side.size();) {
    std::size_t end = i + 1;
    while (end < side.size() && side[end].first == side[i].first) ++end;
    if (end - i == 1) ++faults.boundary;
    if (end - i > 2 || (end - i == 2 && (side[i].second & 1U) == (side[i + 1].second & 1U))) ++faults.nonManifold;
    for (std::size_t j = i; j < end && end - i > 1; ++j) ++neighbours[side[j].second / 2];
    i = end;
  }
  for (const int n : neighbours) faults.dangling += n < 2 ? 1 : 0;
  return faults;
}

std::vector<std::uint8_t> fullFlood(const CarvedField& field, const std::vector<std::uint32_t>& anchors) {
  const BrickLattice& lattice = field.lattice();
  std::vector<std::uint8_t> held(lattice.storage(), 0);
  std::vector<std::uint32_t> stack;
  const auto visit = [&](std::uint32_t n) {
    if (held[n] != 0 || !(field.value(n) < 0.0)) return;
    held[n] = 1;
    stack.push_back(n);
  };
  for (const std::uint32_t n : anchors) visit(n);
  while (!stack.empty()) {
    const Index3 n = lattice.nodeAt(stack.back());
    stack.pop_back();
    for (int a = 0; a < 3; ++a) {
      for (const int step : {-1, 1}) {
        Index3 m = n;
        m[a] += step;
        if (lattice.contains(m)) visit(lattice.node(m));
      }
    }
  }
  return held;
}

std::int64_t insideNodes(const CarvedField& field) {
  std::int64_t count = 0;
  for (std::uint32_t brick = 0; brick < field.lattice().brickCount(); ++brick) count += countBits(field.bits(brick));
  return count;
}

bool samePatches(const CarvedSurface& x, const CarvedSurface& y) {
  if (x.patches() != y.patches() || x.triangles() != y.triangles()) return false;
  std::vector<const SurfacePatch*> list;
  forEachPatch(y, [&](const SurfacePatch& p) { list.push_back(&p); });
  std::size_t i = 0;
  bool same = list.size() == x.patches();
  forEachPatch(x, [&](const SurfacePatch& p) {
    if (!same || i >= list.size()) {
      same = false;
      return;
    }
    const SurfacePatch& q = *list[i++];
    same = p.key == q.key && p.triangleCount == q.triangleCount && p.vertexCount == q.vertexCount &&
           std::memcmp(p.vertex.data(), q.vertex.data(), 4U * p.vertexCount) == 0 &&
           std::memcmp(p.triangle.data(), q.triangle.data(), 4U * p.triangleCount) == 0 &&
           std::memcmp(p.corner.data(), q.corner.data(), 3U * p.triangleCount) == 0;
  });
  return same && i == list.size();
}

}  // namespace calot::test
