// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_organs.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "recorder/errors.h"
#include "recorder/formats/obj.h"
#include "recorder/formats/scene_names.h"
#include "recorder/formats/scene_rules.h"
#include "sim/geometry/surface_report.h"

namespace calot::recorder {

namespace {

constexpr std::size_t mostAnchors = 64;

// A surface that has an inside, of a size that an organ of this scene can have.
SurfaceDescription readSurface(const Asset& asset, LengthUnit unit) {
  TriangleMesh mesh = parseObj(asset.bytes, asset.name, unit);
  const SurfaceReport report = inspectSurface(mesh);
  if (!report.closedManifold()) {
    throw Error(
        ExitCode::damaged,
        fmt::format("{}: {} triangles with {} open edges, {} edges of more than two triangles, {} flipped edges and "
                    "{} parts turned inside out; an organ is a closed outward surface",
                    asset.name, report.triangles, report.openEdges, report.nonManifoldEdges, report.flippedEdges,
                    report.inwardComponents));
  }
  const double size = (report.box.upper - report.box.lower).maxCoeff();
  const double farthest = std::max(report.box.lower.cwiseAbs().maxCoeff(), report.box.upper.cwiseAbs().maxCoeff());
  if (!(size >= 0.001) || !(farthest <= 1.0)) {
    throw Error(ExitCode::damaged,
                fmt::format("{}: {:.4g} m long and up to {:.4g} m from the origin; an organ is at least 0.001 m "
                            "long and within 1 m: is the scene's unit right?",
                            asset.name, size, farthest));
  }
  return {std::move(mesh.vertex), std::move(mesh.triangle)};
}

AnchorDescription readAnchor(const JsonPlace& place) {
  const JsonObject object = place.object(sceneRule("anchor"));
  AnchorDescription anchor;
  if (object.has("sphere") == object.has("nearOrgan")) place.fail("one of \"sphere\" and \"nearOrgan\" is wanted");
  if (object.has("sphere")) {
    const JsonObject sphere = object.at("sphere").object(sceneRule("sphere"));
    sphere.read("centre", anchor.centre);
    sphere.read("radius", anchor.radius);
  } else {
    const JsonObject near = object.at("nearOrgan").object(sceneRule("nearOrgan"));
    anchor.nearOrgan = readName(near, "organ");
    near.read("distance", anchor.distance);
  }
  return anchor;
}

}  // namespace

OrganDescription readOrgan(const JsonPlace& place, const FetchAsset& fetch) {
  const JsonObject object = place.object(sceneRule("organ"));
  OrganDescription organ;
  organ.name = readName(object, "name");
  organ.appearance = readName(object, "appearance");
  object.read("tetrahedra", organ.tetrahedra);
  object.read("friction", organ.friction);
  const JsonObject material = object.at("material").object(sceneRule("material"));
  material.read("youngModulus", organ.material.youngModulus);
  material.read("poissonRatio", organ.material.poissonRatio);
  material.read("density", organ.material.density);
  material.read("massDamping", organ.material.massDamping);
  material.read("stiffnessDamping", organ.material.stiffnessDamping);
  for (const JsonPlace& anchor : object.at("anchors").list(0, mostAnchors)) organ.anchors.push_back(readAnchor(anchor));

  const JsonObject mesh = object.at("mesh").object(sceneRule("mesh"));
  const LengthUnit unit = readWord<LengthUnit>(
      mesh, "unit", {{"m", LengthUnit::metre}, {"cm", LengthUnit::centimetre}, {"mm", LengthUnit::millimetre}});
  const Asset& asset = fetch(readAssetName(mesh, "file"), mesh.at("file"));
  organ.surface = readSurface(asset, unit);
  return organ;
}

void checkOrgans(const JsonPlace& place, const std::vector<OrganDescription>& organs) {
  const auto index = [&](const std::string& name) {
    const auto found =
        std::find_if(organs.begin(), organs.end(), [&](const OrganDescription& o) { return o.name == name; });
    return static_cast<std::size_t>(found - organs.begin());
  };
  const std::vector<JsonPlace> places = place.list(1, mostOrgans);
  for (std::size_t i = 0; i < organs.size(); ++i) {
    const JsonObject object = places[i].object(sceneRule("organ"));
    if (index(organs[i].name) != i) object.at("name").fail("another organ has this name");
    const std::vector<JsonPlace> anchors = object.at("anchors").list(0, mostAnchors);
    for (std::size_t a = 0; a < anchors.size(); ++a) {
      const std::string& near = organs[i].anchors[a].nearOrgan;
      if (near.empty()) continue;
      const JsonPlace name =
          anchors[a].object(sceneRule("anchor")).at("nearOrgan").object(sceneRule("nearOrgan")).at("organ");
      if (index(near) == organs.size()) name.fail("the scene has no organ \"" + near + "\"");
      if (index(near) == i) name.fail("an organ cannot be anchored to itself");
    }
  }
}

}  // namespace calot::recorder
