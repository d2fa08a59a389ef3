// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/ligament_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace calot::gui {
namespace {

constexpr double cell = 0.0035;    // m
constexpr double reach = 0.050;    // how far it goes to the sides, where it has long left the picture below (m)
constexpr double behind = 0.0055;  // its crest, below the upper side of a vessel: as deep as the bile duct is thick (m)
constexpr double crest = 0.015;    // radius of its crest (m)
// What can be injured is not to be hidden: wherever another vessel lies deeper, the fold gives way.
constexpr double under = 0.001;   // below the lower side of every vessel (m)
constexpr double trough = 0.005;  // radius of the trough that it lies in (m)

/// Small folds, so that it is no shell.
double fold(double x, double z) { return 0.0007 * std::sin(310.0 * x + 150.0 * z) * std::sin(240.0 * z - 90.0 * x); }

}  // namespace

Mesh makeLigament(std::span<const Vec3> vessels) {
  Mesh mesh;
  if (vessels.empty()) return mesh;
  Box box;
  for (const Vec3& p : vessels) box.include(p);
  const double x0 = box.lower.x() - reach, z0 = box.lower.z() - reach;
  const auto cells = [](double length) { return static_cast<int>(std::ceil((length + 2.0 * reach) / cell)); };
  const int across = cells(box.upper.x() - box.lower.x()), along = cells(box.upper.z() - box.lower.z());
  for (int i = 0; i <= across; ++i) {
    for (int j = 0; j <= along; ++j) {
      const double x = x0 + i * cell, z = z0 + j * cell;
      double height = -std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::infinity();
      for (const Vec3& p : vessels) {
        const double dx = x - p.x(), dz = z - p.z(), square = dx * dx + dz * dz;
        height = std::max(height, p.y() - 0.5 * square / crest);
        most = std::min(most, p.y() + 0.5 * square / trough);
      }
      mesh.position.emplace_back(x, std::min(height - behind + fold(x, z), most - under), z);
    }
  }
  mesh.triangle = gridTriangles(across + 1, along + 1, false);
  mesh.normal = vertexNormals(mesh.position, mesh.triangle);
  return mesh;
}

}  // namespace calot::gui
