// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/formats/scene_names.h"
#include "recorder/formats/scene_rules.h"
#include "recorder/formats/surface_bytes.h"
#include "sim/geometry/surface_report.h"
#include "sim/math/elementary.h"

namespace calot::recorder {

namespace {

/// x' = scale R x + t, R by Rodrigues' formula from a rotation vector. Nothing is touched where nothing is asked for:
/// scenes without these keys keep their bits.
void placeMesh(const JsonObject& mesh, TriangleMesh& surface) {
  if (!mesh.has("scale") && !mesh.has("rotation") && !mesh.has("translation")) return;
  double scale = 1.0;
  Vec3 rotation = Vec3::Zero(), translation = Vec3::Zero();
  mesh.read("scale", scale);
  mesh.read("rotation", rotation);
  mesh.read("translation", translation);
  const double angle = rotation.norm();
  const Vec3 axis = angle > 0.0 ? Vec3(rotation / angle) : Vec3::UnitX();
  const double c = cosine(angle), s = sine(angle);
  for (Vec3& x : surface.vertex) {
    const Vec3 turned = c * x + s * axis.cross(x) + (1.0 - c) * axis.dot(x) * axis;
    x = scale * turned + translation;
  }
}

}  // namespace

NamedSurface readMesh(const JsonPlace& place, const FetchAsset& fetch) {
  const JsonObject mesh = place.object(sceneRule("mesh"));
  const LengthUnit unit = readWord<LengthUnit>(
      mesh, "unit", {{"m", LengthUnit::metre}, {"cm", LengthUnit::centimetre}, {"mm", LengthUnit::millimetre}});
  const std::string name = readAssetName(mesh, "file");
  if (!isSurfaceName(name)) mesh.at("file").fail("surfaces are read from .obj, .stl and .ply files");
  const Asset& asset = fetch(name, mesh.at("file"));
  NamedSurface surface{parseSurface(asset.bytes, asset.name, unit), asset.name};
  placeMesh(mesh, surface.mesh);
  return surface;
}

SurfaceDescription closedSurface(NamedSurface surface, const char* what) {
  const SurfaceReport report = inspectSurface(surface.mesh);
  if (!report.closedManifold()) {
    throw Error(ErrorKind::damaged, Where{surface.file},
                fmt::format("{} triangles with {} open edges, {} edges of more than two triangles, {} flipped edges "
                            "and {} parts turned inside out; {} is a closed outward surface",
                            report.triangles, report.openEdges, report.nonManifoldEdges, report.flippedEdges,
                            report.inwardComponents, what));
  }
  const double size = (report.box.upper - report.box.lower).maxCoeff();
  const double farthest = std::max(report.box.lower.cwiseAbs().maxCoeff(), report.box.upper.cwiseAbs().maxCoeff());
  if (!(size >= 0.001) || !(farthest <= 1.0)) {
    throw Error(ErrorKind::damaged, Where{surface.file},
                fmt::format("{:.4g} m long and up to {:.4g} m from the origin; {} is at least 0.001 m long and within "
                            "1 m: is the scene's unit right?",
                            size, farthest, what));
  }
  return {std::move(surface.mesh.vertex), std::move(surface.mesh.triangle)};
}

MaterialDescription readMaterial(const JsonPlace& place) {
  const JsonObject object = place.object(sceneRule("material"));
  MaterialDescription material;
  object.read("youngModulus", material.youngModulus);
  object.read("poissonRatio", material.poissonRatio);
  object.read("density", material.density);
  object.read("massDamping", material.massDamping);
  object.read("stiffnessDamping", material.stiffnessDamping);
  return material;
}

}  // namespace calot::recorder
