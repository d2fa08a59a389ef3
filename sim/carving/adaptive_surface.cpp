// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/carving/carved_surface.h"

#include <algorithm>
#include <array>
#include <bit>

#include "sim/math/linear.h"

namespace calot {
namespace {

constexpr int step = 2;           ///< lattice cells along a cell of the base
constexpr int reachBelow = 4;     ///< a block depends on nodes up to its last cell's origin plus this
constexpr int reachAbove = 2;     ///< and down to its first cell's origin minus this
constexpr int iterations = 3;     ///< of the projection onto the surface
constexpr double maxShift = 1.0;  ///< cells that a midpoint may move along each axis

Vec3 unitOrZero(const Vec3& v) {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

}  // namespace

AdaptiveSurface::AdaptiveSurface(const BrickLattice& lattice)
    : lattice_(lattice),
      table_(CubeTable::get()),
      part_(8 * lattice.brickCount()),
      dirty_(8 * lattice.brickCount(), 0) {
  changedBlock_.reserve(part_.size());
}

void AdaptiveSurface::rebuild(const CarvedField& field) {
  changedBlock_.clear();
  for (std::uint32_t b = 0; b < blocks(); ++b) {
    changedBlock_.push_back(b);
    makeBlock(field, b);
  }
}

void AdaptiveSurface::update(const CarvedField& field) {
  changedBlock_.clear();
  for (const std::uint32_t brick : field.changed()) mark(field, brick);
  std::sort(changedBlock_.begin(), changedBlock_.end());
  for (const std::uint32_t b : changedBlock_) {
    dirty_[b] = 0;
    makeBlock(field, b);
  }
}

void AdaptiveSurface::mark(const CarvedField& field, std::uint32_t brick) {
  // Bounds of the changed nodes.
  const BrickBits& raised = field.raised(brick);
  std::uint64_t all = 0;
  Index3 low = Index3::Constant(8);
  Index3 high = Index3::Constant(-1);
  for (int z = 0; z < 8; ++z) {
    if (raised[slot(z)] == 0) continue;
    all |= raised[slot(z)];
    low[2] = std::min(low[2], z);
    high[2] = z;
  }
  for (int i = 0; i < 8; ++i) {
    if ((all & columnFirst << static_cast<unsigned>(i)) != 0) {
      low[0] = std::min(low[0], i);
      high[0] = i;
    }
    if ((all >> static_cast<unsigned>(8 * i) & 0xFFU) != 0) {
      low[1] = std::min(low[1], i);
      high[1] = i;
    }
  }
  if (high[2] < 0) return;
  const Index3 origin = 8 * lattice_.brickAt(brick);
  const Index3 from = (origin + low).array() - reachBelow;
  const Index3 to = (origin + high).array() + reachAbove;
  const Index3 first = from.cwiseMax(0) / 4;
  const Index3 last = (to / 4).cwiseMin((2 * lattice_.bricks().array() - 1).matrix());
  forEachIndex(first, last, [&](const Index3& b) {
    const std::uint32_t in = lattice_.brick(b / 2);
    const std::uint32_t block = 8 * in + static_cast<std::uint32_t>((b[0] & 1) + 2 * (b[1] & 1) + 4 * (b[2] & 1));
    if (dirty_[block] != 0) return;
    dirty_[block] = 1;
    changedBlock_.push_back(block);
  });
}

bool AdaptiveSurface::insideAt(const CarvedField& field, const Index3& node) const {
  return (node.array() < 8 * lattice_.bricks().array()).all() && field.inside(lattice_.node(node));
}

void AdaptiveSurface::makeBlock(const CarvedField& field, std::uint32_t block) {
  Part& part = part_[block];
  triangles_ -= part.triangle.size();
  part.vertex.clear();
  part.triangle.clear();
  side_.clear();
  const auto octant = static_cast<int>(block & 7U);
  const Index3 origin = 8 * lattice_.brickAt(block / 8) + 4 * Index3(octant & 1, octant >> 1 & 1, octant >> 2);
  // No surface if all corners have one sign. Read once.
  std::array<bool, 27> corner{};
  bool any = false;
  bool all = true;
  for (int i = 0; i < 27; ++i) {
    corner[slot(i)] = insideAt(field, origin + step * Index3(i % 3, i / 3 % 3, i / 9));
    any = any || corner[slot(i)];
    all = all && corner[slot(i)];
  }
  if (any && !all) {
    for (int c = 0; c < 8; ++c) makeCell(field, part, origin + step * Index3(c & 1, c >> 1 & 1, c >> 2));
  }
  triangles_ += part.triangle.size();
}

void AdaptiveSurface::makeCell(const CarvedField& field, Part& part, const Index3& cell) {
  unsigned inside = 0;
  for (int c = 0; c < 8; ++c) {
    const Index3 n = cell + step * Index3(c & 1, c >> 1 & 1, c >> 2);
    inside |= static_cast<unsigned>(insideAt(field, n)) << static_cast<unsigned>(c);
  }
  const CubeCase& shape = table_[inside];
  for (std::size_t t = 0; t < shape.count; ++t) {
    std::array<std::uint8_t, 3> v{};
    std::array<int, 3> m{};
    for (std::size_t k = 0; k < 3; ++k) v[k] = baseVertex(field, part, cell, shape.edge[t][k]);
    int split = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      m[k] = middleVertex(field, part, v[k], v[(k + 1) % 3]);
      split += m[k] >= 0 ? 1 : 0;
    }
    const auto add = [&part](int a, int b, int c) {
      part.triangle.push_back(
          {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b), static_cast<std::uint8_t>(c)});
    };
    if (split == 0) {
      add(v[0], v[1], v[2]);
    } else if (split == 3) {
      add(v[0], m[0], m[2]);
      add(v[1], m[1], m[0]);
      add(v[2], m[2], m[1]);
      add(m[0], m[1], m[2]);
    } else {
      // Rotated so that side 0 is split and, if two are, side 1 as well.
      std::size_t k = 0;
      while (m[k] < 0 || (split == 2 && m[(k + 1) % 3] < 0)) ++k;
      const int a = v[k];
      const int b = v[(k + 1) % 3];
      const int c = v[(k + 2) % 3];
      const int ab = m[k];
      const int bc = m[(k + 1) % 3];
      if (split == 1) {
        add(a, ab, c);
        add(ab, b, c);
        continue;
      }
      add(ab, b, bc);
      const auto length = [&part](int i, int j) {
        return (part.vertex[slot(i)].position - part.vertex[slot(j)].position).squaredNorm();
      };
      if (length(a, bc) <= length(ab, c)) {
        add(a, ab, bc);
        add(a, bc, c);
      } else {
        add(a, ab, c);
        add(ab, bc, c);
      }
    }
  }
}

std::uint8_t AdaptiveSurface::baseVertex(const CarvedField& field, Part& part, const Index3& cell, unsigned edge) {
  const auto axis = static_cast<int>(edge / 4);
  Index3 n = cell;
  if ((edge & 1U) != 0) n[(axis + 1) % 3] += step;
  if ((edge & 2U) != 0) n[(axis + 2) % 3] += step;
  const bool first = insideAt(field, n);
  Index3 middle = n;
  ++middle[axis];
  const std::uint32_t v = 3 * lattice_.node(insideAt(field, middle) == first ? middle : n) + edge / 4;
  const std::uint64_t key = std::uint64_t{v} << 32U | v;
  for (std::size_t i = 0; i < part.vertex.size(); ++i) {
    if (part.vertex[i].key == key) return static_cast<std::uint8_t>(i);
  }
  part.vertex.push_back({key, surface_vertex::restPosition(field, v), unitOrZero(gradientAtVertex(field, v))});
  return static_cast<std::uint8_t>(part.vertex.size() - 1);
}

int AdaptiveSurface::middleVertex(const CarvedField& field, Part& part, std::uint8_t a, std::uint8_t b) {
  if (part.vertex[b].key < part.vertex[a].key) std::swap(a, b);
  const std::uint64_t key = (part.vertex[a].key & 0xFFFFFFFF00000000ULL) | (part.vertex[b].key & 0xFFFFFFFFULL);
  for (const Side& side : side_) {
    if (side.key == key) return side.vertex;
  }
  side_.push_back({key, -1});
  const double h = lattice_.cell();
  const Vec3 middle = (0.5 * (part.vertex[a].position + part.vertex[b].position) - lattice_.origin()) / h;
  Vec3 p = middle;
  Vec3 normal = Vec3::Zero();
  for (int i = 0; i < iterations; ++i) {
    const FieldSample sample = sampleField(field, p);
    const double slope2 = sample.gradient.squaredNorm();
    if (!(slope2 > 0.01 * h * h)) {
      if (i == 0) return -1;  // no direction to move in
      break;
    }
    if (i == 0 && !(sample.value * sample.value > tolerance * tolerance * slope2)) return -1;
    normal = sample.gradient;
    p -= sample.value / slope2 * sample.gradient;
    // Clamped around its own midpoint, not its cell: both triangles at the side must get the same vertex.
    p = p.cwiseMax((middle.array() - maxShift).matrix()).cwiseMin((middle.array() + maxShift).matrix());
  }
  part.vertex.push_back({key, lattice_.origin() + h * p, unitOrZero(normal)});
  side_.back().vertex = static_cast<std::int16_t>(part.vertex.size() - 1);
  return side_.back().vertex;
}

TriangleMesh AdaptiveSurface::mesh() const {
  std::size_t maximum = 0;
  for (const Part& part : part_) maximum += part.vertex.size();
  // Vertices that parts share, found by key: open addressing, multiplicative hashing (Knuth, TAOCP 3, 6.4).
  struct Entry {
    std::uint64_t key = 0;
    int vertex = -1;
  };
  const int bits = static_cast<int>(std::bit_width(2 * maximum + 1));
  std::vector<Entry> table(std::size_t{1} << static_cast<unsigned>(bits));
  TriangleMesh mesh;
  mesh.vertex.reserve(maximum);
  mesh.triangle.reserve(triangles_);
  std::vector<int> number;  // of a part's vertices in the mesh
  for (const Part& part : part_) {
    number.clear();
    for (const Vertex& v : part.vertex) {
      std::size_t at = (v.key * 0x9E3779B97F4A7C15ULL) >> static_cast<unsigned>(64 - bits);
      while (table[at].vertex >= 0 && table[at].key != v.key) at = (at + 1) & (table.size() - 1);
      if (table[at].vertex < 0) {
        table[at] = {v.key, static_cast<int>(mesh.vertex.size())};
        mesh.vertex.push_back(v.position);
      }
      number.push_back(table[at].vertex);
    }
    for (const auto& t : part.triangle) mesh.triangle.emplace_back(number[t[0]], number[t[1]], number[t[2]]);
  }
  return mesh;
}

bool AdaptiveSurface::operator==(const AdaptiveSurface& other) const {
  const auto sameBits = [](const Vec3& x, const Vec3& y) {
    bool same = true;
    for (int k = 0; k < 3; ++k) same = same && std::bit_cast<std::uint64_t>(x[k]) == std::bit_cast<std::uint64_t>(y[k]);
    return same;
  };
  const auto sameVertex = [&sameBits](const Vertex& x, const Vertex& y) {
    return x.key == y.key && sameBits(x.position, y.position) && sameBits(x.normal, y.normal);
  };
  return part_.size() == other.part_.size() &&
         std::equal(part_.begin(), part_.end(), other.part_.begin(), [&](const Part& x, const Part& y) {
           return x.triangle == y.triangle &&
                  std::equal(x.vertex.begin(), x.vertex.end(), y.vertex.begin(), y.vertex.end(), sameVertex);
         });
}

FieldSample sampleField(const CarvedField& field, const Vec3& p) {
  const BrickLattice& lattice = field.lattice();
  std::array<std::array<std::uint32_t, 2>, 3> offset{};
  std::array<double, 3> t{};
  for (int a = 0; a < 3; ++a) {
    const int last = lattice.nodes()[a] - 1;
    const double x = std::min(notNegative(p[a]), static_cast<double>(last));
    const int i = std::min(static_cast<int>(x), last - 1);
    t[slot(a)] = x - static_cast<double>(i);
    for (int k = 0; k < 2; ++k) {
      Index3 n = Index3::Zero();
      n[a] = i + k;
      offset[slot(a)][slot(k)] = lattice.node(n);
    }
  }
  std::array<double, 8> v{};
  for (std::size_t c = 0; c < 8; ++c) {
    v[c] = field.value(offset[0][c & 1U] + offset[1][c >> 1U & 1U] + offset[2][c >> 2U]);
  }
  const auto mix = [](double a, double b, double s) { return a + s * (b - a); };
  const double x00 = mix(v[0], v[1], t[0]);
  const double x10 = mix(v[2], v[3], t[0]);
  const double x01 = mix(v[4], v[5], t[0]);
  const double x11 = mix(v[6], v[7], t[0]);
  const double y0 = mix(x00, x10, t[1]);
  const double y1 = mix(x01, x11, t[1]);
  FieldSample sample;
  sample.value = mix(y0, y1, t[2]);
  sample.gradient[0] = mix(mix(v[1] - v[0], v[3] - v[2], t[1]), mix(v[5] - v[4], v[7] - v[6], t[1]), t[2]);
  sample.gradient[1] = mix(x10 - x00, x11 - x01, t[2]);
  sample.gradient[2] = y1 - y0;
  return sample;
}

Vec3 gradientAtVertex(const CarvedField& field, std::uint32_t vertex) {
  const BrickLattice& lattice = field.lattice();
  const std::uint32_t node = vertex / 3;
  const int axis = static_cast<int>(vertex % 3);
  const std::uint32_t end = lattice.next(node, axis);
  const double t = surface_vertex::cut(field, vertex);
  // One end is inside, so at most one coordinate of either, along the edge, can lie on the border.
  const Index3 at = lattice.nodeAt(node);
  Vec3 gradient;
  for (int a = 0; a < 3; ++a) {
    if (a == axis) {
      gradient[a] = field.value(end) - field.value(node);
      continue;
    }
    const bool low = at[a] == 0;
    const bool high = at[a] + 1 >= lattice.nodes()[a];
    const auto along = [&](std::uint32_t n) {
      const double before = field.value(low ? n : lattice.previous(n, a));
      const double after = field.value(high ? n : lattice.next(n, a));
      return 0.5 * (after - before);
    };
    const double first = along(node);
    gradient[a] = first + t * (along(end) - first);
  }
  return gradient;
}

}  // namespace calot
