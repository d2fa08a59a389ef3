// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

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

}  // namespace calot::gui
