// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_assets.h"

#include <fmt/format.h>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/json_reader.h"
#include "recorder/base/record_json.h"
#include "sim/geometry/surface_report.h"
#include "sim/math/elementary.h"
#include "sim/math/floating_point.h"
#include "sim/scene/scene_view.h"
#include "sim/tissue/structure.h"

namespace calot::recorder {

std::vector<Field> MeshFile::fields() {
  using S = MeshFile;
  static const TextRule assetName{200, R"(^(?!\.{1,2}(/|$))[^/\\:]+(/(?!\.{1,2}(/|$))[^/\\:]+)*$)",
                                  "a path relative to the assets folder is expected, with / and without . or .."};
  return {
      object("mesh", "Surface file: OBJ, STL (ASCII or binary), PLY (ASCII or binary) or OFF, by the end of its name"),
      {"file", at<S, &S::file>, assetName,
       "Path relative to the assets folder, with / and without . or .., ending in .obj, .stl, .ply or .off"},
      {"unit", at<S, &S::unit>, lengthUnits(), "Unit of its coordinates"},
      optional("scale", at<S, &S::scale>, "1", within(0.001, 1000),
               "Factor of its coordinates, about their origin: first"),
      optional("rotation", at<S, &S::rotation>, "rad", within(-7, 7),
               "Rotation about the origin, after the scale: along the axis, as long as the angle"),
      optional("translation", at<S, &S::translation>, "m", sceneCoordinate, "Translation, at last"),
  };
}

namespace {

/// A surface as its file has it, and what the file is called in messages.
struct NamedSurface {
  TriangleMesh mesh;  ///< m
  std::string file;
};

/// x' = scale R x + t, R by Rodrigues' formula from a rotation vector. Nothing is touched where nothing is asked for:
/// scenes without these keys keep their bits. Empty where the place has faults that were noted.
NamedSurface readMesh(const JsonPlace& place, const FetchAsset& fetch, std::vector<std::string>& warnings) {
  MeshFile mesh;
  readRecord(place, mesh);
  if (JsonFaults::at({place.pointer()})) return {};
  if (const std::string fault = surfaceNameFault(mesh.file); !fault.empty()) place.at("file").fail(fault);
  const Asset& asset = fetch(mesh.file, place.at("file"));
  std::vector<std::string> notes;
  NamedSurface surface{parseSurface(asset.bytes, asset.name, mesh.unit, {}, &notes), asset.name};
  for (const std::string& note : notes) warnings.push_back(asset.name + ": " + note);
  if (!place.has("scale") && !place.has("rotation") && !place.has("translation")) return surface;
  const double angle = mesh.rotation.norm();
  const Vec3 axis = angle > 0.0 ? Vec3(mesh.rotation / angle) : Vec3::UnitX();
  const double c = cosine(angle), s = sine(angle);
  for (Vec3& x : surface.mesh.vertex) {
    const Vec3 turned = c * x + s * axis.cross(x) + (1.0 - c) * axis.dot(x) * axis;
    x = mesh.scale * turned + mesh.translation;
  }
  return surface;
}

/// @param what "an organ", for messages
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

}  // namespace

SurfaceDescription readOrganSurface(const JsonPlace& mesh, const FetchAsset& fetch,
                                    std::vector<std::string>& warnings) {
  NamedSurface surface = readMesh(mesh, fetch, warnings);
  return surface.file.empty() ? SurfaceDescription{} : closedSurface(std::move(surface), "an organ");
}

std::string repairSummary(const SurfaceRepair& repair) {
  std::string text;
  const auto add = [&text](int count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  };
  add(repair.weldedVertices, "vertices welded");
  add(repair.droppedDegenerate, "triangles without area dropped");
  add(repair.droppedDuplicates, "duplicate triangles dropped");
  add(repair.droppedVertices, "unused vertices dropped");
  add(repair.flippedTriangles, "triangles turned");
  return text;
}

SurfaceDescription readFatSurface(const JsonPlace& mesh, const FetchAsset& fetch, std::vector<std::string>& warnings) {
  NamedSurface surface = readMesh(mesh, fetch, warnings);
  if (surface.file.empty()) return {};
  const std::string file = surface.file;
  int turned = 0;
  // A sound surface is not repaired: the repair would treat a part that starts inside another one as a cavity.
  if (const SurfaceReport found = inspectSurface(surface.mesh);
      !found.closedManifold() || found.coincidentVertices + found.degenerateTriangles + found.unusedVertices > 0) {
    SurfaceRepair repair = repairSurface(surface.mesh);
    turned = repair.flippedTriangles;
    if (repair.changed()) warnings.push_back(file + ": put right before use: " + repairSummary(repair));
    surface.mesh = std::move(repair.mesh);
  }
  SurfaceDescription closed = closedSurface(std::move(surface), "fat");
  const SelfCrossing crossing = findSelfCrossing({closed.vertex, closed.triangle});
  if (crossing.pairs > 0) {
    const std::string where = fmt::format("{}: the surface passes through itself, as at ({:.4f}, {:.4f}, {:.4f}) m",
                                          file, crossing.where[0], crossing.where[1], crossing.where[2]);
    if (turned > 0) {
      throw Error(ErrorKind::damaged,
                  where + ", and its triangles do not agree on what is outside: its inside cannot be determined");
    }
    warnings.push_back(where + "; the region that it winds around is taken as its inside");
  }
  return closed;
}

LoadedScene parseScene(const Asset& file, const FetchAsset& fetch) {
  const FloatingPointScope environment;  // numbers are read and the camera is rotated the same in every process
  const nlohmann::json json = parseStrictJson(file.bytes, file.name);
  const JsonPlace root(json, file.name);
  LoadedScene loaded;
  SceneDescription& scene = loaded.description;
  readRecord(root, scene);
  const auto part = [](auto&& work) { JsonFaults::part(work); };
  part([&] { loaded.summary = root.at("summary").text(500); });
  for (std::size_t i = 0; i < scene.organs.size(); ++i)
    part([&] {
      scene.organs[i].surface = readOrganSurface(root.at("organs").at(i).at("mesh"), fetch, loaded.warnings);
    });
  for (std::size_t i = 0; i < scene.fat.size(); ++i)
    part([&] { scene.fat[i].surface = readFatSurface(root.at("fat").at(i).at("mesh"), fetch, loaded.warnings); });
  applySceneRules(root, scene);
  return loaded;
}

LoadedScene sceneFromAssets(std::vector<Asset> assets) {
  if (assets.empty()) throw Error(ErrorKind::damaged, "scene: there is no scene file among the assets");
  std::vector<bool> used(assets.size(), false);
  used[0] = true;
  for (std::size_t i = 0; i < assets.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (assets[i].name == assets[j].name)
        throw Error(ErrorKind::damaged, "scene: two assets are called " + assets[i].name);
    }
  }
  const FetchAsset fetch = [&](const std::string& name, const JsonPlace& place) -> const Asset& {
    for (std::size_t i = 1; i < assets.size(); ++i) {
      if (assets[i].name != name) continue;
      used[i] = true;
      return assets[i];
    }
    place.fail("there is no asset \"" + name + "\"");
  };
  LoadedScene loaded = parseScene(assets[0], fetch);
  for (std::size_t i = 0; i < assets.size(); ++i) {
    if (!used[i])
      throw Error(ErrorKind::damaged, Where{assets[0].name},
                  fmt::format("the asset {} is named nowhere in it", assets[i].name));
  }
  loaded.assets = std::move(assets);
  return loaded;
}

Vec3 downOf(const Asset& sceneFile) {
  const auto* const text = reinterpret_cast<const char*>(sceneFile.bytes.data());
  const nlohmann::json scene = nlohmann::json::parse(text, text + sceneFile.bytes.size(), nullptr, false);
  const auto found = scene.is_object() ? scene.find("gravity") : scene.end();
  if (found == scene.end() || !found->is_array() || found->size() != 3) return SceneView().down;
  Vec3 gravity;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(*found)[a].is_number()) return SceneView().down;
    gravity[static_cast<int>(a)] = (*found)[a].get<double>();
  }
  return calot::downOf(gravity);
}

}  // namespace calot::recorder
