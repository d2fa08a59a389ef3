// SPDX-License-Identifier: GPL-3.0-or-later
// calot scene: what helps to make a scene of one's own.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "analytics/report/report_document.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/results.h"
#include "apps/calot/scene_template.h"
#include "apps/calot/terminal_text.h"
#include "apps/calot/wrong_word.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_check.h"
#include "recorder/formats/scene_file.h"

namespace calot::apps {
namespace {

nlohmann::ordered_json checkJson(const std::string& file, const recorder::SceneCheck& check) {
  nlohmann::ordered_json faults = nlohmann::ordered_json::array(), costs = nlohmann::ordered_json::array();
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

void printCosts(const recorder::SceneCheck& check) {
  analytics::ReportTable table =
      analytics::tableOf("", {"=organ", "triangles", "edge (mm)", "tetrahedra", "cell (mm)", "=surface"});
  bool fine = false;
  for (const recorder::ContactCost& c : check.costs) {
    table.rows.push_back({c.organ, std::to_string(c.triangles), fmt::format("{:.2f}", 1000.0 * c.meanEdge),
                          std::to_string(c.tetrahedra), fmt::format("{:.2f}", 1000.0 * c.cellSize),
                          c.isFine() ? fmt::format("fine: {} triangles show as much", c.sensibleTriangles) : "right"});
    fine = fine || c.isFine();
  }
  table.print(std::cout, terminalColumns());
  if (fine) std::cout << "calot mesh SURFACE --surface-output F.obj --surface-triangles N makes a coarser surface\n";
  std::cout << std::flush;
}

int checkOne(const std::string& name, bool json) {
  const std::filesystem::path file = recorder::findScene(name, assetFolders());
  const recorder::SceneCheck check = recorder::checkScene(file);
  if (json) {
    printResult("scene-check", checkJson(file.string(), check));
  } else {
    for (const Error& fault : check.faults) fmt::print("fault: {}\n", fault.what());
    for (const std::string& note : check.notes) fmt::print("note: {}\n", note);
    std::fflush(stdout);
    if (!check.costs.empty()) printCosts(check);
  }
  if (check.faults.empty()) {
    if (!json) fmt::print("{}: sound, {} notes\n", file.string(), check.notes.size());
    return static_cast<int>(ExitCode::yes);
  }
  throw Error(ErrorKind::damaged, fmt::format("{}: {} faults", file.string(), check.faults.size()));
}

}  // namespace

void addScene(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("scene", "Make a scene of one's own: a template, and a check");
  command->require_subcommand(1);

  struct CheckOptions {
    std::string scene;
    bool json = false;
  };
  const auto c = std::make_shared<CheckOptions>();
  CLI::App* check = command->add_subcommand(
      "check", "Say all faults of a scene at once, what catches nothing in it, and surfaces that are too fine");
  check->add_option("scene", c->scene, "name of a scene (calot scenes), or a scene file")->required();
  check->add_flag("--json", c->json, "print the result as JSON");
  check->callback([c, &run] { run = [c] { return checkOne(c->scene, c->json); }; });

  const auto t = std::make_shared<SceneTemplate>();
  CLI::App* made = command->add_subcommand(
      "template", "Write a scene of one organ that can be recorded at once, and be changed from there");
  made->add_option("surface", t->surface, "the organ's closed surface, a .obj, .stl or .ply file (calot mesh --repair)")
      ->required();
  made->add_option("--unit", t->unit, "of its coordinates: m, cm or mm")->required()->check(oneOf({"m", "cm", "mm"}));
  made->add_option("-o,--output", t->output, "the scene, FOLDER/scenes/NAME.json; the surface goes into FOLDER/organs")
      ->required();
  made->add_option("--tetrahedra", t->tetrahedra, "of the organ")->check(CLI::Range(12, 100000))->capture_default_str();
  made->add_flag("--force", t->force, "replace files that are there");
  made->callback([t, &run] {
    run = [t] {
      for (const std::filesystem::path& file : writeSceneTemplate(*t)) fmt::print("{}\n", file.string());
      return static_cast<int>(ExitCode::yes);
    };
  });
}

}  // namespace calot::apps
