// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_file.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/json_reader.h"
#include "recorder/base/text_words.h"
#include "sim/geometry/surface_distance.h"
#include "sim/math/floating_point.h"
#include "sim/scene/model.h"

namespace calot::recorder {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t maxMesh = std::size_t{256} << 20U;

}  // namespace

LoadedScene loadScene(const fs::path& sceneFile) {
  const fs::path folder = sceneFile.has_parent_path() ? sceneFile.parent_path() : fs::path(".");
  const bool inScenes = folder.filename() == "scenes";
  const fs::path root = inScenes ? folder / ".." : folder;
  const std::string base = sceneFile.filename().string();
  std::vector<Asset> assets;
  assets.reserve(maxStructures + 1);  // references to the elements stay good
  assets.push_back({inScenes ? "scenes/" + base : base, {}});
  assets[0].bytes = readFileBytes(sceneFile, assets[0].name, maxMesh);

  const FetchAsset fetch = [&](const std::string& name, const JsonPlace& place) -> const Asset& {
    const auto known = std::find_if(assets.begin() + 1, assets.end(), [&](const Asset& a) { return a.name == name; });
    if (known != assets.end()) return *known;
    std::error_code ignored;
    const fs::path path = root / name;
    if (!fs::is_regular_file(path, ignored)) place.fail("there is no file \"" + name + "\" in the assets folder");
    // A link may lead out of the folder, whatever its name says.
    const fs::path home = fs::weakly_canonical(root, ignored);
    const fs::path real = fs::weakly_canonical(path, ignored);
    if (std::mismatch(home.begin(), home.end(), real.begin(), real.end()).first != home.end()) {
      place.fail("\"" + name + "\" leads out of the assets folder");
    }
    assets.push_back({name, readFileBytes(path, name, maxMesh)});
    return assets.back();
  };
  LoadedScene loaded = parseScene(assets[0], fetch);
  loaded.assets = std::move(assets);
  return loaded;
}

std::vector<fs::path> listScenes(const std::vector<fs::path>& roots) {
  std::vector<fs::path> files;
  for (const auto& [name, file] : filesIn(roots, "scenes")) files.push_back(file);
  return files;
}

fs::path findScene(const std::string& name, const std::vector<fs::path>& roots) {
  return findJsonFile(name, roots, "scenes", "scene", "scene file");
}

namespace {

/// Edges of a surface that are this share of a cell follow what the cells can do.
constexpr double sensibleEdge = 1.0 / 3.0;
/// Multiple of the sensible number of triangles, and absolute number, from which a note is given.
constexpr std::size_t timesSensible = 4, fewTriangles = 20000;

/// By how much an anchor misses a node (m); 0 or less: it catches it.
double missOf(const AnchorDescription& anchor, const Vec3& node, const SurfaceDistance* near) {
  return near == nullptr ? (node - anchor.centre).norm() - anchor.radius : near->signedDistance(node) - anchor.distance;
}

void checkAnchors(const Model& model, std::vector<std::string>& notes) {
  const SceneDescription& scene = model.scene();
  std::map<std::string, std::unique_ptr<SurfaceDistance>> surfaces;
  for (std::size_t o = 0; o < scene.organs.size(); ++o) {
    for (std::size_t a = 0; a < scene.organs[o].anchors.size(); ++a) {
      const AnchorDescription& anchor = scene.organs[o].anchors[a];
      const SurfaceDistance* near = nullptr;
      if (!anchor.nearOrgan.empty()) {
        std::unique_ptr<SurfaceDistance>& kept = surfaces[anchor.nearOrgan];
        for (const OrganDescription& other : scene.organs) {
          if (!kept && other.name == anchor.nearOrgan) kept = std::make_unique<SurfaceDistance>(other.surface.mesh());
        }
        near = kept.get();
      }
      double least = std::numeric_limits<double>::infinity();
      for (const Vec3& node : model.organs()[o].solid.rest()) least = std::min(least, missOf(anchor, node, near));
      if (least <= 0.0) continue;
      notes.push_back(
          fmt::format("/organs/{}/anchors/{}: catches no node of {}; the nearest is {:.1f} mm beyond it: move it, or "
                      "make it larger",
                      o, a, scene.organs[o].name, 1000.0 * least));
    }
  }
}

void checkAttachments(const Model& model, std::vector<std::string>& notes) {
  const SceneDescription& scene = model.scene();
  for (std::size_t f = 0; f < scene.fat.size(); ++f) {
    for (std::size_t a = 0; a < scene.fat[f].attachments.size(); ++a) {
      const FatAttachmentDescription& attachment = scene.fat[f].attachments[a];
      const std::size_t structure = model.structureNamed(attachment.to);
      if (structure == model.structures().size()) continue;
      const std::size_t body = model.structures()[structure].body;
      const bool ties = std::any_of(model.ties().begin(), model.ties().end(),
                                    [&](const Tie& tie) { return tie.fat == f && tie.body[0] == body; });
      if (ties) continue;
      notes.push_back(
          fmt::format("/fat/{}/attachments/{}: ties nothing of {} to {}: no fat is within {:.1f} mm of it; make the "
                      "distance larger, or leave it out",
                      f, a, scene.fat[f].name, attachment.to, 1000.0 * attachment.distance));
    }
  }
}

void checkHeld(const Model& model, std::vector<std::string>& notes) {
  for (std::size_t body = 0; body < model.bodies(); ++body) {
    if (model.holds(body)) continue;
    for (const StructureModel& structure : model.structures()) {
      if (structure.body != body) continue;
      notes.push_back(
          fmt::format("{}: nothing holds it: it falls out of the picture; anchor or tie it", structure.name));
      break;
    }
  }
}

ContactCost costOf(const OrganModel& organ) {
  ContactCost cost;
  cost.organ = organ.name;
  cost.triangles = organ.surface.triangles().size();
  cost.tetrahedra = organ.solid.tetrahedra().size();
  cost.cellSize = organ.cellSize;
  double area = 0.0;
  for (const double each : organ.triangleArea) area += each;
  // Edge of equilateral triangles of that area: area = sqrt(3) / 4 edge^2.
  const double equilateral = std::sqrt(3.0) / 4.0;
  cost.meanEdge = std::sqrt(area / static_cast<double>(cost.triangles) / equilateral);
  const double sensible = sensibleEdge * organ.cellSize;
  cost.sensibleTriangles = static_cast<std::size_t>(area / (equilateral * sensible * sensible));
  return cost;
}

}  // namespace

bool ContactCost::isFine() const { return triangles > fewTriangles && triangles > timesSensible * sensibleTriangles; }

SceneCheck checkScene(const std::filesystem::path& sceneFile) {
  SceneCheck check;
  std::optional<LoadedScene> loaded;
  {
    JsonFaults faults;
    try {
      loaded = loadScene(sceneFile);
    } catch (const Error& fault) {
      if (fault.kind() != ErrorKind::damaged) throw;
      faults.note(fault);
    }
    check.faults = faults.found();
  }
  if (loaded) {
    check.scene = loaded->description.name;
    check.notes = loaded->warnings;
  }
  if (!check.faults.empty()) return check;
  const FloatingPointScope floatingPoint;
  const Model::Built built = Model::build(std::move(loaded->description));
  if (!built.model) {
    check.faults.emplace_back(ErrorKind::damaged, Where{sceneFile.string()}, built.error);
    return check;
  }
  checkAnchors(*built.model, check.notes);
  checkAttachments(*built.model, check.notes);
  checkHeld(*built.model, check.notes);
  for (std::size_t o = 0; o < built.model->organs().size(); ++o) {
    check.costs.push_back(costOf(built.model->organs()[o]));
    const ContactCost& cost = check.costs.back();
    if (!cost.isFine()) continue;
    check.notes.push_back(fmt::format(
        "/organs/{}/mesh: {} triangles, edges of {:.2f} mm, over tetrahedra of {:.1f} mm: {} triangles show "
        "as much, and leave less to prepare and to draw",
        o, cost.triangles, 1000.0 * cost.meanEdge, 1000.0 * cost.cellSize, cost.sensibleTriangles));
  }
  return check;
}

}  // namespace calot::recorder
