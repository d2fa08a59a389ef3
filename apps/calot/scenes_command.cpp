// SPDX-License-Identifier: GPL-3.0-or-later
// calot scenes: what can be simulated.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "analytics/report/report_document.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/results.h"
#include "apps/calot/terminal_text.h"
#include "apps/common/advice.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"
#include "sim/scene/model.h"

namespace calot::apps {
namespace {

using nlohmann::json;

std::string versionOf(const SceneDescription& scene) {
  return fmt::format("{}.{}", scene.majorVersion, scene.minorVersion);
}

void printTable(const std::vector<recorder::LoadedScene>& scenes) {
  analytics::ReportTable table = analytics::tableOf("", {"=scene", "version", "=organs (tetrahedra)", "=summary"});
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
  json organs = json::array();
  for (const OrganModel& organ : model.organs()) {
    organs.push_back({{"name", organ.name},
                      {"tetrahedra", organ.solid.tetrahedra().size()},
                      {"nodes", organ.solid.nodes()},
                      {"triangles", organ.surface.triangles().size()}});
  }
  row["organs"] = organs;
  json vessels = json::array();
  for (const VesselTree& tree : model.vesselTrees()) {
    for (std::size_t b = 0; b < tree.vessel.size(); ++b) {
      vessels.push_back(
          {{"name", model.scene().vessels[tree.vessel[b]].name}, {"beams", tree.beams.branches()[b].elements()}});
    }
  }
  row["vessels"] = vessels;
  json fat = json::array();
  for (std::size_t i = 0; i < model.fat().size(); ++i) {
    const FatModel& body = *model.fat()[i];
    fat.push_back({{"name", model.scene().fat[i].name},
                   {"cell_size_m", body.lattice().cell()},
                   {"hexahedra", body.solid().cubes().size()}});
  }
  row["fat"] = fat;
  json connective = json::array();
  for (const ConnectiveModel& c : model.connective())
    connective.push_back({{"name", c.name}, {"springs", c.tissue.strands().size()}});
  row["connective"] = connective;
  row["ties"] = model.ties().size();
}

void printJson(std::vector<recorder::LoadedScene> scenes) {
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

}  // namespace

void addScenes(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("scenes", "List the scenes that can be simulated");
  const auto asJson = std::make_shared<bool>(false);
  command->add_flag("--json", *asJson, "Print JSON, with what each scene is built of");
  command->callback([&run, asJson] {
    run = [asJson] {
      const std::vector<std::filesystem::path> files = recorder::listScenes(assetFolders());
      if (files.empty())
        throw Error(ErrorKind::invalid, "no scenes were found; set CALOT_ASSETS to the folder that holds \"scenes\"");
      std::vector<recorder::LoadedScene> scenes;
      // A scene that cannot be read is named, and the others are listed all the same.
      bool damaged = false;
      for (const std::filesystem::path& file : files) {
        try {
          scenes.push_back(recorder::loadScene(file));
          for (const std::string& warning : scenes.back().warnings) {
            fmt::print(stderr, "calot: warning: {}\n", warning);
          }
        } catch (const Error& fault) {
          if (fault.kind() != ErrorKind::damaged) throw;
          fmt::print(stderr, "calot: {}\n", messageOf(fault));
          damaged = true;
        }
      }
      *asJson ? printJson(std::move(scenes)) : printTable(scenes);
      return static_cast<int>(damaged ? ExitCode::damaged : ExitCode::yes);
    };
  });
}

}  // namespace calot::apps
