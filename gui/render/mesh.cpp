// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "sim/geometry/ground.h"

namespace calot::gui {

std::vector<Vec3> vertexNormals(const std::vector<Vec3>& position, const std::vector<Index3>& triangle) {
  std::vector<Vec3> normal(position.size(), Vec3::Zero());
  const auto at = [](auto& list, int i) -> auto& { return list[static_cast<std::size_t>(i)]; };
  for (const Index3& t : triangle) {
    const Vec3 area = (at(position, t[1]) - at(position, t[0])).cross(at(position, t[2]) - at(position, t[0]));
    for (int a = 0; a < 3; ++a) at(normal, t[a]) += area;
  }
  for (Vec3& n : normal) {
    const double length = n.norm();
    n = length > 1e-30 ? Vec3(n / length) : Vec3::UnitZ();
  }
  return normal;
}

void closeGrid(Mesh& mesh, int rows, int columns, bool closed) {
  const auto at = [&](int row, int column) { return row * columns + column % columns; };
  for (int i = 0; i + 1 < rows; ++i) {
    for (int j = 0; j < (closed ? columns : columns - 1); ++j) {
      mesh.triangle.emplace_back(at(i, j), at(i, j + 1), at(i + 1, j));
      mesh.triangle.emplace_back(at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
    }
  }
  mesh.normal = vertexNormals(mesh.position, mesh.triangle);
}

namespace {

void addCap(Mesh& mesh, const Ring& ring, bool atEnd) {
  Vec3 centre = Vec3::Zero(), area = Vec3::Zero();
  for (const Vec3& p : ring) centre += p / static_cast<double>(ring.size());
  for (std::size_t k = 0; k < ring.size(); ++k) area += (ring[k] - centre).cross(ring[(k + 1) % ring.size()] - centre);
  const double length = area.norm();
  if (length < 1e-16) return;
  const Vec3 normal = (atEnd ? 1.0 : -1.0) * area / length;
  const int first = static_cast<int>(mesh.position.size());
  const int n = static_cast<int>(ring.size());
  mesh.position.push_back(centre);
  mesh.position.insert(mesh.position.end(), ring.begin(), ring.end());
  mesh.normal.insert(mesh.normal.end(), ring.size() + 1, normal);
  for (int k = 0; k < n; ++k) {
    const int a = first + 1 + k, b = first + 1 + (k + 1) % n;
    mesh.triangle.emplace_back(first, atEnd ? a : b, atEnd ? b : a);
  }
}

constexpr int rings = 48;     // from pole to pole
constexpr int segments = 96;  // around

// A few low waves: folds of peritoneum and omentum, a few per cent of the radius.
double unevenness(const Vec3& d) {
  return 0.035 * std::sin(5.0 * d.x() + 1.3 * d.z()) * std::sin(4.0 * d.y() + 0.7) +
         0.020 * std::sin(11.0 * d.z() + 3.0 * d.y()) * std::sin(9.0 * d.x() - 1.1) +
         0.010 * std::sin(23.0 * d.y() + 5.0 * d.x()) * std::sin(19.0 * d.z() + 2.0);
}

/// A surface over a grid in the horizontal plane. @param height y over (x, z)
template <class Height>
Mesh surfaceOver(double x0, double z0, int across, int along, double cell, Height height) {
  Mesh mesh;
  for (int i = 0; i <= across; ++i) {
    for (int j = 0; j <= along; ++j) {
      const double x = x0 + i * cell, z = z0 + j * cell;
      mesh.position.emplace_back(x, height(x, z), z);
    }
  }
  closeGrid(mesh, across + 1, along + 1, false);
  return mesh;
}

constexpr double gap = 0.002;     // between all of it and what may not be hidden (m)
constexpr double buried = 0.011;  // how far the omentum's highest fold lies below the bowel's highest (m)

// The omentum: a grid of cells about the hilum, from below the camera to below the liver.
constexpr double omentumCell = 0.007;  // m
constexpr double halfWidth = 0.24, towards = 0.13, beyond = 0.22;

/// Folds of the apron, from 0 down (m): long ones across it, lobes on them.
double apron(double x, double z) {
  const double longFolds = std::sin(61.0 * x + 22.0 * z + 1.5 * std::sin(34.0 * z));
  const double lobes = std::sin(230.0 * x + 60.0 * z + 0.4) * std::sin(190.0 * z - 90.0 * x);
  return 0.0042 * (longFolds - 1.0) + 0.0026 * (lobes - 1.0);
}

/// Towards its border it sinks away, so that nobody sees one.
double sunk(double share) { return 0.06 * std::pow(std::abs(share), 8.0); }

Mesh omentum(double x0, double z0, double top) {
  const int across = static_cast<int>(2.0 * halfWidth / omentumCell),
            along = static_cast<int>((towards + beyond) / omentumCell);
  return surfaceOver(x0 - halfWidth, z0 - towards, across, along, omentumCell,
                     [&](double x, double z) { return top + apron(x, z) - sunk((x - x0) / halfWidth); });
}

/// A piece of gut along a path in the horizontal plane: a tube that bulges between furrows.
struct Gut {
  std::span<const std::array<double, 2>> path;  ///< x, z from the hilum (m)
  double radius;                                ///< at its bulges (m)
  double furrows;                               ///< distance from one to the next (m)
  double depth;                                 ///< of a furrow, share of the radius
};

// Assumed: sizes of adults' bowel that is neither empty nor blown up.
constexpr std::array<std::array<double, 2>, 7> colonPath{
    {{0.150, 0.155}, {0.152, 0.105}, {0.138, 0.060}, {0.102, 0.024}, {0.074, -0.012}, {0.066, -0.050}, {0.074, -0.10}}};
constexpr std::array<std::array<double, 2>, 5> duodenumPath{
    {{-0.14, 0.020}, {-0.09, 0.018}, {-0.055, -0.002}, {-0.040, -0.035}, {-0.043, -0.09}}};
constexpr std::array<Gut, 2> guts{{{colonPath, 0.0175, 0.026, 0.16}, {duodenumPath, 0.0135, 0.011, 0.035}}};

/// Between the points of a path as Catmull and Rom have it.
std::vector<Vec3> smoothed(const Gut& gut, double x0, double z0, double y) {
  const auto at = [&](std::ptrdiff_t i) {
    const auto last = static_cast<std::ptrdiff_t>(gut.path.size()) - 1;
    const std::array<double, 2>& p = gut.path[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, last))];
    return Vec3(x0 + p[0], y, z0 + p[1]);
  };
  constexpr int parts = 10;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i + 1 < gut.path.size(); ++i) {
    const auto k = static_cast<std::ptrdiff_t>(i);
    const Vec3 a = at(k - 1), b = at(k), c = at(k + 1), d = at(k + 2);
    for (int part = 0; part < parts; ++part) {
      const double t = static_cast<double>(part) / parts;
      points.emplace_back(b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a))));
    }
  }
  points.push_back(at(static_cast<std::ptrdiff_t>(gut.path.size()) - 1));
  return points;
}

Mesh tubeOf(const Gut& gut, double x0, double z0, double top) {
  constexpr int around = 20;
  const std::vector<Vec3> path = smoothed(gut, x0, z0, top - gut.radius);
  std::vector<Ring> rings;
  double gone = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    // It comes up out of the omentum and goes down into it: nobody sees an end.
    const double place = 2.0 * static_cast<double>(i) / static_cast<double>(path.size() - 1) - 1.0;
    const Vec3 middle = path[i] - Vec3(0.0, 0.05 * std::pow(std::abs(place), 9.0), 0.0);
    const Vec3 along = (path[std::min(i + 1, path.size() - 1)] - path[i > 0 ? i - 1 : 0]).normalized();
    const Vec3 side = Vec3::UnitY().cross(along).normalized();
    if (i > 0) gone += (path[i] - path[i - 1]).norm();
    // A furrow is sharp, a bulge round.
    const double bulge = std::abs(std::sin(std::numbers::pi * gone / gut.furrows));
    const double radius = gut.radius * (1.0 - gut.depth * (1.0 - std::pow(bulge, 0.6)));
    Ring& ring = rings.emplace_back();
    for (int k = 0; k < around; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / around;
      ring.emplace_back(middle + radius * (std::cos(angle) * side + std::sin(angle) * Vec3::UnitY()));
    }
  }
  return loft(rings);
}

void append(Mesh& to, const Mesh& mesh) {
  const Index3 first = Index3::Constant(static_cast<int>(to.position.size()));
  to.position.insert(to.position.end(), mesh.position.begin(), mesh.position.end());
  to.normal.insert(to.normal.end(), mesh.normal.begin(), mesh.normal.end());
  for (const Index3& t : mesh.triangle) to.triangle.emplace_back(t + first);
}

/// Ligament and viscera are made for scenes whose y is up: their y of `down` is below this. In others they could hide
/// what is operated on.
constexpr double yUpBelow = -0.5;

bool isOfHilum(StructureRole role) { return role == StructureRole::bileDuct || role == StructureRole::artery; }

/// Height of the lowest point of what is operated on, and of what may be injured (m). The liver's lower border may lie
/// in the omentum.
double lowestOf(const SceneView& view) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const SurfaceView& surface : view.surface) {
    if (surface.role == StructureRole::liver) continue;
    for (const Vec3& p : surface.rest) lowest = std::min(lowest, p.y());
  }
  return lowest;
}

constexpr double cell = 0.0035;          // m
constexpr double ligamentReach = 0.050;  // how far it goes to the sides, where it has long left the picture below (m)
constexpr double behind = 0.0055;  // its crest, below the upper side of a vessel: as deep as the bile duct is thick (m)
constexpr double crest = 0.015;    // radius of its crest (m)
// Vessels that can be injured must stay visible: wherever another vessel lies deeper, the fold gives way.
constexpr double under = 0.001;   // below the lower side of every vessel (m)
constexpr double trough = 0.005;  // radius of the trough that it lies in (m)

/// Small folds, so that it is no shell.
double fold(double x, double z) { return 0.0007 * std::sin(310.0 * x + 150.0 * z) * std::sin(240.0 * z - 90.0 * x); }

}  // namespace

Mesh loft(const std::vector<Ring>& rings) {
  Mesh mesh;
  const int n = static_cast<int>(rings.front().size());
  for (const Ring& ring : rings) mesh.position.insert(mesh.position.end(), ring.begin(), ring.end());
  for (int r = 0; r + 1 < static_cast<int>(rings.size()); ++r)
    for (int k = 0; k < n; ++k) {
      const int a = r * n + k, b = r * n + (k + 1) % n;
      mesh.triangle.emplace_back(a, b, b + n);
      mesh.triangle.emplace_back(a, b + n, a + n);
    }
  mesh.normal = vertexNormals(mesh.position, mesh.triangle);
  addCap(mesh, rings.front(), false);
  addCap(mesh, rings.back(), true);
  return mesh;
}

Ring superellipse(const Vec3& centre, double a, double b, double e, int n) {
  Ring ring;
  for (int k = 0; k < n; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / n;
    const double c = std::cos(angle), s = std::sin(angle);
    ring.push_back(centre + Vec3(std::copysign(a * std::pow(std::abs(c), 2.0 / e), c),
                                 std::copysign(b * std::pow(std::abs(s), 2.0 / e), s), 0.0));
  }
  return ring;
}

Mesh tube(const std::vector<Vec3>& path, double radius, int n) {
  std::vector<Ring> rings;
  const std::size_t last = path.size() - 1;
  const auto tangent = [&](std::size_t i) -> Vec3 {
    return (path[std::min(i + 1, last)] - path[i > 0 ? i - 1 : 0]).normalized();
  };
  // A side vector is carried along the path, so that the tube does not twist.
  Vec3 side = tangent(0).unitOrthogonal();
  const auto ringAt = [&](const Vec3& centre, const Vec3& t, double r) {
    side = (side - side.dot(t) * t).normalized();
    const Vec3 up = t.cross(side);
    Ring ring;
    for (int k = 0; k < n; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / n;
      ring.push_back(centre + r * (std::cos(angle) * side + std::sin(angle) * up));
    }
    rings.push_back(ring);
  };
  constexpr int roundings = 4;
  for (int k = 0; k < roundings; ++k) {
    const double angle = 0.5 * std::numbers::pi * (k + 0.5) / roundings;
    ringAt(path.front() - radius * std::cos(angle) * tangent(0), tangent(0), radius * std::sin(angle));
  }
  for (std::size_t i = 0; i <= last; ++i) ringAt(path[i], tangent(i), radius);
  for (int k = roundings - 1; k >= 0; --k) {
    const double angle = 0.5 * std::numbers::pi * (k + 0.5) / roundings;
    ringAt(path.back() + radius * std::cos(angle) * tangent(last), tangent(last), radius * std::sin(angle));
  }
  return loft(rings);
}

Mesh moved(Mesh mesh, const Quat& rotation, const Vec3& translation) {
  for (Vec3& p : mesh.position) p = rotation * p + translation;
  for (Vec3& d : mesh.normal) d = rotation * d;
  return mesh;
}

CavityShape cavityShape(const SceneView& view) {
  Box box;
  for (const SurfaceView& surface : view.surface)
    for (const Vec3& p : surface.rest) box.include(p);
  const bool empty = (box.lower.array() > box.upper.array()).any();
  const Vec3 centre = empty ? Vec3(view.camera.position + view.camera.orientation.normalized() * Vec3(0.0, 0.0, 0.08))
                            : Vec3(0.5 * (box.lower + box.upper));
  double radius = 0.12;
  for (const SurfaceView& surface : view.surface)
    for (const Vec3& p : surface.rest) radius = std::max(radius, (p - centre).norm());
  for (const InstrumentView& instrument : view.instrument)
    if (instrument.kind != InstrumentKind::none)
      radius = std::max(radius, std::min(0.25, (instrument.port - centre).norm()));
  return {centre, 1.15 * radius};
}

Mesh makeCavity(const CavityShape& shape) {
  Mesh mesh;
  for (int i = 0; i <= rings; ++i) {
    const double polar = std::numbers::pi * i / rings;
    for (int j = 0; j < segments; ++j) {
      const double around = 2.0 * std::numbers::pi * j / segments;
      const Vec3 d(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar));
      mesh.position.push_back(shape.centre + shape.radius * (1.0 + unevenness(d)) * d);
    }
  }
  closeGrid(mesh, rings + 1, segments, true);
  return mesh;
}

Viscera makeViscera(std::span<const Vec3> vessels, double lowest) {
  Viscera viscera;
  if (vessels.empty()) return viscera;
  Box box;
  for (const Vec3& p : vessels) box.include(p);
  const Vec3 hilum = 0.5 * (box.lower + box.upper);
  const double top = lowest - gap;
  viscera.omentum = omentum(hilum.x(), hilum.z(), top - buried);
  for (const Gut& gut : guts) append(viscera.bowel, tubeOf(gut, hilum.x(), hilum.z(), top));
  return viscera;
}

void Surroundings::update(const SceneView& view) {
  if (const CavityShape shape = cavityShape(view); shape != shape_) {
    wall = makeCavity(shape);
    shape_ = shape;
  }
  std::vector<Vec3> vessels;
  for (const SurfaceView& surface : view.surface)
    if (view.down.y() < yUpBelow && isOfHilum(surface.role))
      vessels.insert(vessels.end(), surface.rest.begin(), surface.rest.end());
  if (vessels == vessels_) return;
  ligament = makeLigament(vessels);
  viscera = makeViscera(vessels, lowestOf(view));
  vessels_ = std::move(vessels);
}

Pose Surroundings::restOf(const ClipView& clip, const Vec3& down) const {
  constexpr double fall = 0.25;  // recorder/engine/fallen_clips.h
  const Vec3 from = clip.pose.position - fall * down;
  Ground highest;
  for (const Mesh* mesh : {&viscera.bowel, &viscera.omentum, &ligament}) {
    const Ground ground = groundBelow(mesh->position, mesh->triangle, from, down);
    if (ground.below < highest.below) highest = ground;
  }
  if (highest.below >= fall) return clip.pose;
  const Vec3 up = clip.pose.orientation * Vec3::UnitZ();
  return {from + highest.below * down + 0.5 * clip.width * highest.normal,
          Quat::FromTwoVectors(up, highest.normal) * clip.pose.orientation};
}

Mesh makeLigament(std::span<const Vec3> vessels) {
  if (vessels.empty()) return {};
  Box box;
  for (const Vec3& p : vessels) box.include(p);
  const double x0 = box.lower.x() - ligamentReach, z0 = box.lower.z() - ligamentReach;
  const auto cells = [](double length) { return static_cast<int>(std::ceil((length + 2.0 * ligamentReach) / cell)); };
  const int across = cells(box.upper.x() - box.lower.x()), along = cells(box.upper.z() - box.lower.z());
  return surfaceOver(x0, z0, across, along, cell, [&](double x, double z) {
    double height = -std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::infinity();
    for (const Vec3& p : vessels) {
      const double dx = x - p.x(), dz = z - p.z(), square = dx * dx + dz * dz;
      height = std::max(height, p.y() - 0.5 * square / crest);
      most = std::min(most, p.y() + 0.5 * square / trough);
    }
    return std::min(height - behind + fold(x, z), most - under);
  });
}

}  // namespace calot::gui
