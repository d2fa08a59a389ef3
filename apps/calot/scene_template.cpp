// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/scene_template.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/base/text_output.h"
#include "recorder/formats/mesh_file.h"
#include "sim/geometry/surface_report.h"

namespace calot::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// To a hundredth of a millimetre: a file that people change.
double rounded(double x) { return std::round(1e5 * x) / 1e5 + 0.0; }
Json listOf(const Vec3& v) { return Json::array({rounded(v[0]), rounded(v[1]), rounded(v[2])}); }

/// The endoscope looks along +z from the front, ports lie above (+y): as in the scenes that come with Calot.
Json sceneOf(const std::string& name, const std::string& file, const SceneTemplate& wanted, const Box& box) {
  const Vec3 middle = 0.5 * (box.lower + box.upper);
  const Vec3 half = 0.5 * (box.upper - box.lower);
  const double reach = std::max(half.maxCoeff(), 0.02);
  const Vec3 room = half + Vec3::Constant(0.03 + 0.5 * reach);
  Json hands;
  for (const auto& [hand, side] : {std::pair{"left", 1.0}, std::pair{"right", -1.0}}) {
    hands[hand] = {{"port", listOf({side * 0.6 * reach, room[1] + 0.05, -half[2] - 0.02})},
                   {"home", listOf({side * 0.3 * reach, half[1] + 0.015, -half[2] - 0.01})},
                   {"instrument", "grasper"}};
  }
  Json anchor;
  anchor["sphere"] = {{"centre", listOf({0.0, 0.0, half[2]})}, {"radius", rounded(0.6 * reach)}};
  Json organ{{"name", "organ"}, {"appearance", "liver"}, {"role", "other"}};
  organ["mesh"] = {{"file", file}, {"unit", wanted.unit}, {"translation", listOf(-middle)}};
  organ["tetrahedra"] = wanted.tetrahedra;
  organ["material"] = {{"youngModulus", 5000},
                       {"poissonRatio", 0.45},
                       {"density", 1060},
                       {"massDamping", 0},
                       {"stiffnessDamping", 0.01}};
  organ["anchors"] = Json::array({anchor});

  Json scene{{"format", "calot-scene"}, {"formatVersion", 1}, {"name", name}};
  scene["version"] = {{"major", 1}, {"minor", 0}};
  scene["summary"] = "A scene of one organ, to begin with.";
  scene["gravity"] = Json::array({0, -9.81, 0});
  scene["workspace"] = {{"lower", listOf(-room)}, {"upper", listOf(room)}};
  scene["camera"] = {{"position", listOf({0.0, 0.5 * reach, -half[2] - 2.5 * reach})},
                     {"target", Json::array({0, 0, 0})},
                     {"up", Json::array({0, 1, 0})},
                     {"verticalFieldOfView", 1.0}};
  scene["hands"] = hands;
  scene["organs"] = Json::array({organ});
  return scene;
}

}  // namespace

std::vector<fs::path> writeSceneTemplate(const SceneTemplate& wanted) {
  const fs::path scene = wanted.output;
  if (scene.extension() != ".json")
    throw Error(ErrorKind::invalid, Where{wanted.output}, "a scene's name ends in .json");
  const fs::path folder = scene.parent_path();
  const fs::path root = folder.filename() == "scenes" ? folder.parent_path() : folder;
  const fs::path organs = root / "organs";
  const fs::path surface = organs / fs::path(wanted.surface).filename();
  const TriangleMesh mesh = recorder::readSurface(wanted.surface, recorder::parseLengthUnit(wanted.unit));
  const SurfaceReport found = inspectSurface(mesh);
  if (!found.closedManifold()) {
    throw Error(
        ErrorKind::refused, Where{wanted.surface},
        fmt::format("is not closed and outward: {} open edges, {} edges of more than two triangles, {} flipped; "
                    "calot mesh --repair --surface-output F.obj makes one that is",
                    found.openEdges, found.nonManifoldEdges, found.flippedEdges));
  }
  const double size = (found.box.upper - found.box.lower).maxCoeff();
  if (!(size >= 0.001 && size <= 0.5)) {
    throw Error(ErrorKind::invalid, Where{wanted.surface},
                fmt::format("{:.4g} m long in {}; an organ of a template is 1 mm to 0.5 m long: is --unit right?", size,
                            wanted.unit));
  }
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (!error) fs::create_directories(organs, error);
  if (error) throw Error(ErrorKind::failure, Where{root.string()}, "cannot be made: " + error.message());
  for (const fs::path& file : {scene, surface}) {
    if (!fs::equivalent(file, wanted.surface, error)) recorder::refuseOutput(file, wanted.force);
  }
  const std::string name = scene.stem().string();
  if (!fs::equivalent(surface, wanted.surface, error)) {
    const std::vector<std::byte> bytes = recorder::readFileBytes(wanted.surface, wanted.surface, std::size_t{1} << 28U);
    recorder::writeText(surface, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, wanted.force);
  }
  recorder::writeText(scene, sceneOf(name, "organs/" + surface.filename().string(), wanted, found.box).dump(2) + "\n",
                      wanted.force);
  return {scene, surface};
}

}  // namespace calot::apps
