// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/geometry/closest_point_transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sim/math/linear.h"

namespace calot {

namespace {

/// A convex set as an intersection of half-spaces, in lattice coordinates (nodes are integers). Rows run along one
/// axis: half-spaces bound a row from below or above, or contain or exclude it entirely.
class ConvexScan {
 public:
  static constexpr std::size_t capacity = 96;  ///< further half-spaces are ignored, which only enlarges the set
  static constexpr double slack = 1e-6;        ///< by which each half-space is enlarged (cells)

  /// @param axis direction of the rows, ideally that in which the set is longest
  /// @param nodes of the lattice along each axis
  ConvexScan(int axis, const Index3& nodes) : w_(axis), u_((axis + 1) % 3), v_((axis + 2) % 3), nodes_(nodes) {}

  /// Adds {p: normal . (p - at) >= 0}. @param normal of unit length
  void add(const Vec3& normal, const Vec3& at) { add(normal, normal.dot(at)); }
  /// Adds {p: normal . p >= offset}.
  void add(const Vec3& normal, double offset) {
    if (count_ == capacity) return;
    Plane& p = plane_[count_++];
    p.u = normal[u_];
    p.v = normal[v_];
    p.offset = offset - slack;
    const double along = normal[w_];
    // Rows nearly parallel to the plane: their height changes by less than the slack over the lattice.
    p.kind = along > 1e-9 ? 1 : (along < -1e-9 ? -1 : 0);
    p.inverse = p.kind == 0 ? 0.0 : 1.0 / along;
  }

  /// Calls visit(n) for each lattice point in the box that lies in all half-spaces.
  template <class Visit>
  void run(const Box& box, Visit&& visit) const {
    Index3 from;
    Index3 to;
    for (int a = 0; a < 3; ++a) {
      const double last = static_cast<double>(nodes_[a] - 1);
      from[a] = up(std::min(notNegative(box.lower[a] - slack), last + 1.0));
      to[a] = static_cast<int>(std::clamp(box.upper[a] + slack, -1.0, last) + 1.0) - 1;
    }
    Index3 n;
    for (n[v_] = from[v_]; n[v_] <= to[v_]; ++n[v_]) {
      for (n[u_] = from[u_]; n[u_] <= to[u_]; ++n[u_]) {
        double low = from[w_];
        double high = to[w_];
        if (!row(n[u_], n[v_], low, high)) continue;
        const int last = static_cast<int>(high + 1.0) - 1;
        for (n[w_] = up(low); n[w_] <= last; ++n[w_]) visit(n);
      }
    }
  }

 private:
  struct Plane {
    double u = 0.0;
    double v = 0.0;
    double offset = 0.0;
    double inverse = 0.0;
    int kind = 0;
  };

  /// Smallest integer not below x. @pre x >= 0
  static int up(double x) {
    const int i = static_cast<int>(x);
    return i + (static_cast<double>(i) < x ? 1 : 0);
  }

  /// Intersects [low, high] (both within the lattice) with the half-spaces.
  bool row(double u, double v, double& low, double& high) const {
    for (std::size_t i = 0; i < count_; ++i) {
      const Plane& p = plane_[i];
      const double remainder = p.offset - (p.u * u + p.v * v);
      if (p.kind > 0) {
        low = std::max(low, remainder * p.inverse);
      } else if (p.kind < 0) {
        high = std::min(high, remainder * p.inverse);
      } else if (remainder > 0.0) {
        return false;
      }
      if (low > high) return false;
    }
    return true;
  }

  int w_;
  int u_;
  int v_;
  Index3 nodes_;
  std::array<Plane, capacity> plane_;
  std::size_t count_ = 0;
};

int maxAxis(const Vec3& v) {
  int axis = 0;
  v.cwiseAbs().maxCoeff(&axis);
  return axis;
}

/// Distances in cells, in the order of the lattice's storage, and the surface in lattice coordinates.
class Transform {
 public:
  Transform(const std::vector<Vec3>& vertex, const TriangleMesh& mesh, const SurfaceFeatures& features,
            const BrickLattice& lattice, double band, std::vector<double>& value)
      : vertex_(vertex), mesh_(mesh), features_(features), lattice_(lattice), band_(band), value_(value) {
    for (int a = 0; a < 3; ++a) {
      std::vector<std::uint32_t>& offset = offset_[slot(a)];
      for (int i = 0; i < lattice.nodes()[a]; ++i) {
        Index3 n = Index3::Zero();
        n[a] = i;
        offset.push_back(lattice.node(n));
      }
    }
  }

  void run() {
    for (std::size_t t = 0; t < mesh_.triangle.size(); ++t) scanFace(t);
    for (const SurfaceFeatures::Edge& edge : features_.edges()) scanEdge(edge);
    for (int v = 0; v < mesh_.vertices(); ++v) scanVertex(v);
  }

 private:
  /// The index of a node is a sum over its coordinates, brick by brick as within a brick.
  double& at(const Index3& n) {
    return value_[offset_[0][slot(n[0])] + offset_[1][slot(n[1])] + offset_[2][slot(n[2])]];
  }
  void offer(const Index3& n, double squared, bool inside) {
    double& value = at(n);
    if (!(squared < value * value)) return;
    const double d = std::sqrt(squared);
    value = inside ? -d : d;
  }
  static Vec3 point(const Index3& n) {
    return {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
  }

  /// The prism on a face. Only nodes that project into the face: beside it, its plane would be too near.
  void scanFace(std::size_t t) {
    const SurfaceFeatures::Face& face = features_.faces()[t];
    if (!face.flat()) return;
    std::array<const Vec3*, 3> p{};
    Box box;
    for (int k = 0; k < 3; ++k) {
      p[slot(k)] = &vertex_[slot(mesh_.triangle[t][k])];
      box.include(*p[slot(k)]);
    }
    const Vec3 reach = band_ * face.normal.cwiseAbs();
    box.lower -= reach;
    box.upper += reach;
    ConvexScan scan(maxAxis(face.normal), lattice_.nodes());
    const double height = face.normal.dot(*p[0]);
    scan.add(face.normal, height - band_);
    scan.add(-face.normal, -height - band_);
    std::array<double, 3> border{};
    for (std::size_t k = 0; k < 3; ++k) {
      border[k] = face.inward[k].dot(*p[k]);
      scan.add(face.inward[k], border[k]);
    }
    scan.run(box, [&](const Index3& n) {
      const Vec3 x = point(n);
      const double d = face.normal.dot(x) - height;
      double& value = at(n);
      if (!(std::abs(d) < std::abs(value))) return;
      for (std::size_t k = 0; k < 3; ++k) {
        if (face.inward[k].dot(x) < border[k]) return;
      }
      value = d;
    });
  }

  /// The wedge of an edge: between its ends, beyond each of its faces.
  void scanEdge(const SurfaceFeatures::Edge& edge) {
    const Vec3& a = vertex_[slot(edge.low)];
    const Vec3& b = vertex_[slot(edge.high)];
    const Vec3 ab = b - a;
    const double length = ab.norm();
    if (!(length > 0.0)) return;
    const Vec3 t = ab / length;
    std::array<Vec3, 2> normal{};
    std::array<Vec3, 2> inward{};
    std::size_t flat = 0;
    for (const SurfaceFeatures::Side& side : features_.sides(edge)) {
      const SurfaceFeatures::Face& face = features_.faces()[slot(side.triangle)];
      if (face.flat() && flat < 2) {
        normal[flat] = face.normal;
        inward[flat] = face.inward[slot(side.side)];
      }
      flat += face.flat() ? 1 : 0;
    }
    Box box;
    box.include(a);
    box.include(b);
    Vec3 along = edge.normal;
    const double bend = inward[1].dot(normal[0]);
    if (flat == 2 && normal[0].dot(normal[1]) > 0.0 && std::abs(bend) > 1e-6) {
      // Between the normals on the convex side; its outermost corner is where the two caps meet.
      const double out = bend < 0.0 ? band_ : -band_;
      const Vec3 tip = out * (normal[0] + normal[1]) / (1.0 + normal[0].dot(normal[1]));
      for (const Vec3* end : {&a, &b}) {
        box.include(*end + out * normal[0]);
        box.include(*end + out * normal[1]);
        box.include(*end + tip);
      }
    } else {
      const Vec3 reach = band_ * notNegative(Vec3(1.0 - t.cwiseAbs2().array())).cwiseSqrt();
      box.lower -= reach;
      box.upper += reach;
      if (!(along.squaredNorm() > 0.0)) along = reach;
    }
    ConvexScan scan(maxAxis(along), lattice_.nodes());
    scan.add(t, a);
    scan.add(-t, b);
    for (const SurfaceFeatures::Side& side : features_.sides(edge)) {
      const SurfaceFeatures::Face& face = features_.faces()[slot(side.triangle)];
      if (face.flat()) scan.add(-face.inward[slot(side.side)], a);
    }
    scan.run(box, [&](const Index3& n) {
      const Vec3 x = point(n) - a;
      const double s = std::min(notNegative(t.dot(x)), length);
      const Vec3 q = x - s * t;
      offer(n, q.squaredNorm(), edge.normal.dot(q) < 0.0);
    });
  }

  /// The cone of a vertex: behind all of its edges, seen from it.
  void scanVertex(int v) {
    const Vec3& p = vertex_[slot(v)];
    direction_.clear();
    for (const int e : features_.edgesAt(v)) {
      const SurfaceFeatures::Edge& edge = features_.edges()[slot(e)];
      const Vec3 d = vertex_[slot(edge.low == v ? edge.high : edge.low)] - p;
      const double length = d.norm();
      if (length > 0.0) direction_.emplace_back(d / length);
    }
    Box box;
    Vec3 along = Vec3::UnitX();
    if (!coneBox(box, along)) return;
    box.lower += p;
    box.upper += p;
    ConvexScan scan(maxAxis(along), lattice_.nodes());
    for (const Vec3& d : direction_) scan.add(-d, p);
    const Vec3& normal = features_.vertexNormals()[slot(v)];
    scan.run(box, [&](const Index3& n) {
      const Vec3 q = point(n) - p;
      offer(n, q.squaredNorm(), normal.dot(q) < 0.0);
    });
  }

  /// Box around {q: q . d <= 0 for all directions d, |q| <= band}, through the set's extreme rays, which are normal to
  /// two directions each. @return false: only the vertex itself, which the edges' ends cover
  bool coneBox(Box& box, Vec3& along) {
    ray_.clear();
    bool crossed = false;
    for (std::size_t i = 0; i < direction_.size(); ++i) {
      for (std::size_t j = i + 1; j < direction_.size(); ++j) {
        const Vec3 cross = direction_[i].cross(direction_[j]);
        const double length = cross.norm();
        if (!(length > 1e-9)) continue;
        crossed = true;
        const Vec3 ray = cross / length;
        double maximum = 0.0;
        double minimum = 0.0;
        for (const Vec3& d : direction_) {
          const double c = ray.dot(d);
          maximum = std::max(maximum, c);
          minimum = std::min(minimum, c);
          if (maximum > 1e-6 && minimum < -1e-6) break;
        }
        if (maximum <= 1e-6) ray_.push_back(ray);
        if (minimum >= -1e-6) ray_.emplace_back(-ray);
      }
    }
    if (crossed && ray_.empty()) return false;
    Vec3 sum = Vec3::Zero();
    for (const Vec3& ray : ray_) sum += ray;
    double cosine = -1.0;
    if (sum.norm() > 1e-3) {
      along = sum / sum.norm();
      cosine = 1.0;
      for (const Vec3& ray : ray_) cosine = std::min(cosine, along.dot(ray));
      cosine -= 1e-5;
    }
    box.lower = Vec3::Constant(-band_);
    box.upper = Vec3::Constant(band_);
    if (!(cosine > 0.1)) return true;
    // Within a round cone of less than a right angle about `along`.
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    for (int a = 0; a < 3; ++a) {
      const double w = along[a];
      const double across = std::sqrt(std::max(0.0, 1.0 - w * w)) * sine;
      box.upper[a] = w >= cosine ? band_ : band_ * std::max(0.0, w * cosine + across);
      box.lower[a] = -w >= cosine ? -band_ : -band_ * std::max(0.0, -w * cosine + across);
    }
    return true;
  }

  const std::vector<Vec3>& vertex_;
  const TriangleMesh& mesh_;
  const SurfaceFeatures& features_;
  const BrickLattice& lattice_;
  double band_;
  std::vector<double>& value_;
  std::array<std::vector<std::uint32_t>, 3> offset_;
  std::vector<Vec3> direction_;
  std::vector<Vec3> ray_;
};

std::string fault(const std::vector<Vec3>& vertex, const TriangleMesh& mesh, const BrickLattice& lattice, double band) {
  if (mesh.triangle.empty()) return "the surface has no triangles";
  if (!(band > 1.0)) return "the band must be wider than one cell";
  const Vec3 last = (lattice.nodes().array() - 1).cast<double>();
  for (std::size_t v = 0; v < vertex.size(); ++v) {
    if (!vertex[v].allFinite()) return "vertex " + std::to_string(v) + " is not finite";
    if ((vertex[v].array() < 1.0).any() || (vertex[v].array() > last.array() - 1.0).any()) {
      return "vertex " + std::to_string(v) +
             " is less than a cell from the lattice's border: a wider lattice is needed";
    }
  }
  return {};
}

}  // namespace

DistanceTransform closestPointTransform(const TriangleMesh& mesh, const BrickLattice& lattice, double band) {
  DistanceTransform result;
  result.band = band * lattice.cell();
  std::vector<Vec3> vertex;
  vertex.reserve(mesh.vertex.size());
  for (const Vec3& p : mesh.vertex) vertex.emplace_back((p - lattice.origin()) / lattice.cell());
  result.error = fault(vertex, mesh, lattice, band);
  if (!result.error.empty()) return result;

  const SurfaceFeatures features(vertex, mesh.triangle);
  if (features.openEdges() > 0) {
    result.error = "the surface is not closed: " + std::to_string(features.openEdges()) +
                   " edges have no partner that runs the other way; close it, or join its vertices and turn its faces";
    return result;
  }
  result.value.assign(lattice.storage(), band);
  Transform(vertex, mesh, features, lattice, band, result.value).run();

  if (!features.manifoldEdges() || !spreadSigns(lattice, band, result.value)) {
    result.rule = SignRule::regions;
    signByRegions(mesh, lattice, band, result.value);
    if (std::none_of(result.value.begin(), result.value.end(), [](double d) { return d < 0.0; })) {
      result.error = "the surface winds around nothing: is it inside out?";
      result.value.clear();
      return result;
    }
  }
  for (double& d : result.value) d *= lattice.cell();
  return result;
}

}  // namespace calot
