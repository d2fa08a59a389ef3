// SPDX-License-Identifier: GPL-3.0-or-later
// calot scene: what helps to make a scene of one's own.
// calot scenes: what can be simulated.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "analytics/uncertainty/uncertainty.h"
#include "apps/calot/command.h"
#include "apps/calot/environment.h"
#include "recorder/base/counted.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/formats/mesh_file.h"
#include "recorder/formats/scene_file.h"
#include "sim/geometry/surface_report.h"
#include "sim/scene/model.h"

namespace calot::apps {
namespace {

using nlohmann::json;

std::string versionOf(const SceneDescription& scene) {
  return fmt::format("{}.{}", scene.majorVersion, scene.minorVersion);
}

void printScenes(const std::vector<recorder::LoadedScene>& scenes) {
  analytics::ReportTable table = analytics::tableOf("", {"=scene", "version", "=organs (tetrahedra)", "=summary"});
  table.leastNeeded = {"organs (tetrahedra)"};
  for (const recorder::LoadedScene& scene : scenes) {
    std::string organs;
    for (const OrganDescription& organ : scene.description.organs) {
      organs += fmt::format("{}{} ({})", organs.empty() ? "" : ", ", organ.name, organ.tetrahedra);
    }
    table.rows.push_back({scene.description.name, versionOf(scene.description), organs, scene.summary});
  }
  table.print(std::cout, terminalColumns());
}

/// Numerical settings of a scene's step.
void addCounts(const Model& model, json& row) {
  json& organs = row["organs"] = json::array();
  for (const OrganModel& organ : model.organs()) {
    organs.push_back({{"name", organ.name},
                      {"tetrahedra", organ.solid.tetrahedra().size()},
                      {"nodes", organ.solid.nodes()},
                      {"triangles", organ.surface.triangles().size()}});
  }
  json& vessels = row["vessels"] = json::array();
  for (const VesselTree& tree : model.vesselTrees()) {
    for (std::size_t b = 0; b < tree.vessel.size(); ++b) {
      vessels.push_back(
          {{"name", model.scene().vessels[tree.vessel[b]].name}, {"beams", tree.beams.branches()[b].elements()}});
    }
  }
  json& fat = row["fat"] = json::array();
  for (std::size_t i = 0; i < model.fat().size(); ++i) {
    const FatModel& body = *model.fat()[i];
    fat.push_back({{"name", model.scene().fat[i].name},
                   {"cell_size_m", body.lattice().cell()},
                   {"hexahedra", body.solid().cubes().size()}});
  }
  json& connective = row["connective"] = json::array();
  for (const ConnectiveModel& c : model.connective())
    connective.push_back({{"name", c.name}, {"springs", c.tissue.strands().size()}});
  row["ties"] = model.ties().size();
}

void printScenesJson(std::vector<recorder::LoadedScene> scenes) {
  json list = json::array();
  for (recorder::LoadedScene& scene : scenes) {
    json row = {{"name", scene.description.name},
                {"version", versionOf(scene.description)},
                {"summary", scene.summary},
                {"ticks_per_step", scene.description.ticksPerStep}};
    const std::string name = scene.description.name;
    const Model::Built built = Model::build(std::move(scene.description));
    if (!built.model) throw Error(ErrorKind::damaged, fmt::format("scene {}: {}", name, built.error));
    addCounts(*built.model, row);
    list.push_back(std::move(row));
  }
  printResult("scenes", {{"scenes", list}});
}

ExitCode listScenes(const JsonOption& o) {
  const std::vector<std::filesystem::path> files = recorder::listScenes(assetFolders());
  if (files.empty())
    throw Error(ErrorKind::invalid, "no scenes were found; set CALOT_ASSETS to the folder that holds \"scenes\"");
  std::vector<recorder::LoadedScene> scenes;
  bool damaged = false;  // such a scene is named, and the others are listed all the same
  for (const std::filesystem::path& file : files) {
    try {
      scenes.push_back(recorder::loadScene(file));
      for (const std::string& warning : scenes.back().warnings) fmt::print(stderr, "calot: warning: {}\n", warning);
    } catch (const Error& fault) {
      if (fault.kind() != ErrorKind::damaged) throw;
      fmt::print(stderr, "calot: {}\n", messageOf(fault));
      damaged = true;
    }
  }
  o.json ? printScenesJson(std::move(scenes)) : printScenes(scenes);
  return damaged ? ExitCode::damaged : ExitCode::yes;
}

struct SceneCheckOptions {
  std::string scene;
  bool json = false;
};

Json checkJson(const std::string& file, const recorder::SceneCheck& check) {
  Json faults = Json::array(), costs = Json::array();
  for (const Error& fault : check.faults)
    faults.push_back({{"file", fault.where().file}, {"place", fault.where().place}, {"fault", fault.fault()}});
  for (const recorder::ContactCost& c : check.costs) {
    costs.push_back({{"organ", c.organ},
                     {"triangles", c.triangles},
                     {"mean_edge_m", c.meanEdge},
                     {"tetrahedra", c.tetrahedra},
                     {"cell_size_m", c.cellSize},
                     {"sensible_triangles", c.sensibleTriangles},
                     {"fine", c.isFine()}});
  }
  return {{"file", file},     {"scene", check.scene}, {"sound", check.faults.empty()},
          {"faults", faults}, {"notes", check.notes}, {"surfaces", costs}};
}

void printCosts(const recorder::SceneCheck& check, std::ostream& out) {
  analytics::ReportTable table =
      analytics::tableOf("", {"=organ", "triangles", "edge (mm)", "tetrahedra", "cell (mm)", "=surface"});
  bool fine = false;
  for (const recorder::ContactCost& c : check.costs) {
    table.rows.push_back({c.organ, std::to_string(c.triangles), fmt::format("{:.2f}", 1000.0 * c.meanEdge),
                          std::to_string(c.tetrahedra), fmt::format("{:.2f}", 1000.0 * c.cellSize),
                          c.isFine() ? fmt::format("fine: {} triangles show as much", c.sensibleTriangles) : "right"});
    fine = fine || c.isFine();
  }
  table.print(out, terminalColumns());
  if (fine) out << "calot mesh SURFACE --surface-output F.obj --surface-triangles N makes a coarser surface\n";
}

void checkScene(const SceneCheckOptions& o) {
  const std::filesystem::path file = recorder::findScene(o.scene, assetFolders());
  Progress progress("Checking the scene", o.json);
  const recorder::SceneCheck check = recorder::checkScene(file);
  printResult(o.json, "scene-check", checkJson(file.string(), check), [&](std::ostream& out) {
    for (const Error& fault : check.faults) out << fmt::format("fault: {}\n", fault.what());
    for (const std::string& note : check.notes) out << fmt::format("note: {}\n", note);
    if (!check.costs.empty()) printCosts(check, out);
  });
  if (!check.faults.empty())
    throw Error(ErrorKind::damaged,
                fmt::format("{}: {}", file.string(), recorder::counted(check.faults.size(), "fault")));
  if (!o.json) printText(fmt::format("{}: sound, {}\n", file.string(), recorder::counted(check.notes.size(), "note")));
}

struct SceneTemplate {
  std::string surface, unit, output;
  int tetrahedra = 1000;
  bool force = false;
};

namespace fs = std::filesystem;

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

/// Writes a scene file of one organ in the middle of the workspace, held on its side away from the endoscope, with two
/// graspers, and copies the surface beside it. The surface is placed by the scene's translation; its file stays as it
/// is. @throws Error where the surface is open or of no organ's size, or something is there
void writeSceneTemplate(const SceneTemplate& wanted) {
  const fs::path scene = wanted.output;
  if (scene.extension() != ".json")
    throw Error(ErrorKind::invalid, Where{wanted.output}, "a scene's name ends in .json");
  const fs::path folder = scene.parent_path();
  const fs::path root = folder.filename() == "scenes" ? folder.parent_path() : folder;
  const fs::path organs = root / "organs";
  const fs::path surface = organs / fs::path(wanted.surface).filename();
  std::vector<std::string> notes;
  const TriangleMesh mesh = recorder::readSurface(wanted.surface, recorder::parseLengthUnit(wanted.unit), {}, &notes);
  for (const std::string& note : notes) fmt::print(stderr, "calot: warning: {}: {}\n", wanted.surface, note);
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
  fmt::print("{}\n{}\n", scene.string(), surface.string());
}

struct SceneDivision {
  std::string scene, output;
  double elements = 1.0;
  std::optional<std::uint32_t> ticksPerStep;
  bool force = false;
};

std::string textOf(const recorder::Asset& asset) {
  return {reinterpret_cast<const char*>(asset.bytes.data()), asset.bytes.size()};
}

/// The scene's file with other numbers of elements and ticks, all else as it is.
/// @throws Error (refused) where no scene can be built with them
std::string dividedText(const recorder::LoadedScene& scene, const SceneDivision& wanted) {
  const SceneDescription divided = analytics::redivided(
      scene.description, wanted.ticksPerStep.value_or(scene.description.ticksPerStep), wanted.elements);
  Json file = Json::parse(textOf(scene.assets.front()));
  file["name"] = fs::path(wanted.output).stem().string();
  file["ticksPerStep"] = divided.ticksPerStep;
  const auto write = [&file](const char* list, const char* key, const auto& parts, auto member) {
    for (std::size_t i = 0; i < parts.size(); ++i) file[list][i][key] = parts[i].*member;
  };
  write("organs", "tetrahedra", divided.organs, &OrganDescription::tetrahedra);
  write("vessels", "elements", divided.vessels, &VesselDescription::elements);
  write("connective", "strands", divided.connective, &ConnectiveDescription::strands);
  write("fat", "cellsPerCube", divided.fat, &FatDescription::cellsPerCube);
  std::string text = file.dump(2) + "\n";
  std::vector<recorder::Asset> assets = scene.assets;
  const auto* const bytes = reinterpret_cast<const std::byte*>(text.data());
  assets.front().bytes.assign(bytes, bytes + text.size());
  try {
    const Model::Built built = Model::build(recorder::sceneFromAssets(std::move(assets)).description);
    if (!built.model) throw Error(ErrorKind::refused, built.error);
  } catch (const Error& fault) {
    throw Error(ErrorKind::refused, Where{wanted.scene, fault.where().place}, "cannot be divided so: " + fault.fault());
  }
  return text;
}

bool isThere(const fs::path& path, const std::string& text) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored) || fs::file_size(path, ignored) != text.size()) return false;
  return textOf({{}, recorder::readFileBytes(path, path.string(), text.size())}) == text;
}

/// Writes a scene divided otherwise, and its surfaces beside it as they are. What is there alike stays.
/// @throws Error as dividedText(), and where another file is there
void divideScene(const SceneDivision& wanted) {
  const fs::path output = wanted.output;
  if (output.extension() != ".json")
    throw Error(ErrorKind::invalid, Where{wanted.output}, "a scene's name ends in .json");
  const recorder::LoadedScene scene = recorder::loadScene(recorder::findScene(wanted.scene, assetFolders()));
  const fs::path folder = output.parent_path();
  const fs::path root = folder.filename() == "scenes" ? folder.parent_path() : folder;
  Progress progress("Dividing the scene");
  std::vector<std::pair<fs::path, std::string>> files;
  for (std::size_t i = 1; i < scene.assets.size(); ++i)
    files.emplace_back(root / scene.assets[i].name, textOf(scene.assets[i]));
  files.emplace_back(output, dividedText(scene, wanted));  // the last: with it all is there
  for (const auto& [path, text] : files) {
    std::error_code error;
    if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
    if (error)
      throw Error(ErrorKind::failure, Where{path.parent_path().string()}, "cannot be made: " + error.message());
    if (!isThere(path, text)) recorder::refuseOutput(path, wanted.force);
  }
  for (const auto& [path, text] : files) {
    if (!isThere(path, text)) recorder::writeText(path, text, wanted.force);
    printText(path.string() + '\n');
  }
}

}  // namespace

void addScenes(CLI::App& app, Run& run) {
  const auto [command, o] =
      addCommand(app, run, {"scenes", "List the scenes that can be simulated", "calot scenes"}, listScenes);
  command->add_flag("--json", o->json, "Print JSON, with what each scene is built of");
}

void addScene(CLI::App& app, Run& run) {
  CLI::App& command = addGroup(
      app, {"scene", "Make a scene of one's own: a template, and a check", "calot scene check my/scenes/press.json"});

  const auto [check, c] = addCommand(
      command, run,
      {"check", "Say all faults of a scene at once, what catches nothing in it, and surfaces that are too fine",
       "calot scene check my/scenes/press.json"},
      checkScene);
  check->add_option("scene", c->scene, "name of a scene (calot scenes), or a scene file")->required();
  check->add_flag("--json", c->json, "print the result as JSON");

  const auto [made, t] =
      addCommand(command, run,
                 {"template", "Write a scene of one organ that can be recorded at once, and be changed from there",
                  "calot scene template liver.stl --unit mm -o my/scenes/press.json"},
                 writeSceneTemplate);
  made->add_option("surface", t->surface,
                   "the organ's closed surface, a .obj, .stl, .ply or .off file (calot mesh --repair)")
      ->required();
  made->add_option("--unit", t->unit, "of its coordinates: m, cm or mm")->required()->check(oneOf({"m", "cm", "mm"}));
  made->add_option("-o,--output", t->output, "the scene, FOLDER/scenes/NAME.json; the surface goes into FOLDER/organs")
      ->required();
  addNumber(*made, "--tetrahedra", t->tetrahedra, "of the organ", 12, 100000);
  made->add_flag("--force", t->force, "replace files that are there");

  const auto [divide, d] =
      addCommand(command, run,
                 {"divide", "Write a scene with more or fewer elements, or another step, all else as it is",
                  "calot scene divide carve-fat --elements 2 -o my/scenes/carve-fat-finer.json"},
                 divideScene);
  divide->add_option("scene", d->scene, "name of a scene (calot scenes), or a scene file")->required();
  addNumber(*divide, "--elements", d->elements,
            "times the tetrahedra; vessels' elements, strands and fat's cubes by the same ratio of lengths", 0.1, 16.0);
  divide->add_option("--ticks-per-step", d->ticksPerStep, "ticks of 1 ms in a step; without it those of the scene")
      ->check(CLI::Range(1, 100));
  divide->add_option("-o,--output", d->output, "the scene, FOLDER/scenes/NAME.json; the surfaces go into FOLDER")
      ->required();
  divide->add_flag("--force", d->force, "replace files that are there");
}

}  // namespace calot::apps
