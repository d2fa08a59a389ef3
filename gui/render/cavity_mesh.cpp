// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/cavity_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace calot::gui {
namespace {

constexpr int rings = 48;     // from pole to pole
constexpr int segments = 96;  // around

// A few low waves: folds of peritoneum and omentum, a few per cent of the radius.
double unevenness(const Vec3& d) {
  return 0.035 * std::sin(5.0 * d.x() + 1.3 * d.z()) * std::sin(4.0 * d.y() + 0.7) +
         0.020 * std::sin(11.0 * d.z() + 3.0 * d.y()) * std::sin(9.0 * d.x() - 1.1) +
         0.010 * std::sin(23.0 * d.y() + 5.0 * d.x()) * std::sin(19.0 * d.z() + 2.0);
}

}  // namespace

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
  mesh.triangle = gridTriangles(rings + 1, segments, true);
  mesh.normal = vertexNormals(mesh.position, mesh.triangle);
  return mesh;
}

}  // namespace calot::gui
