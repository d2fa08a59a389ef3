// SPDX-License-Identifier: GPL-3.0-or-later
// calot scenes: what can be simulated.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "recorder/errors.h"
#include "recorder/formats/scene_file.h"

namespace calot::apps {
namespace {

using nlohmann::json;

std::string versionOf(const SceneDescription& scene) {
  return fmt::format("{}.{}", scene.majorVersion, scene.minorVersion);
}

void printTable(const std::vector<recorder::LoadedScene>& scenes) {
  fmt::print("{:<16} {:<8} {:<40} {}\n", "scene", "version", "organs (tetrahedra)", "summary");
  for (const recorder::LoadedScene& scene : scenes) {
    std::string organs;
    for (const OrganDescription& organ : scene.description.organs) {
      organs += fmt::format("{}{} ({})", organs.empty() ? "" : ", ", organ.name, organ.tetrahedra);
    }
    fmt::print("{:<16} {:<8} {:<40} {}\n", scene.description.name, versionOf(scene.description), organs, scene.summary);
  }
}

void printJson(const std::vector<recorder::LoadedScene>& scenes) {
  json list = json::array();
  for (const recorder::LoadedScene& scene : scenes) {
    json organs = json::array();
    for (const OrganDescription& organ : scene.description.organs) {
      organs.push_back(
          {{"name", organ.name}, {"tetrahedra", organ.tetrahedra}, {"triangles", organ.surface.triangle.size()}});
    }
    list.push_back({{"name", scene.description.name},
                    {"version", versionOf(scene.description)},
                    {"summary", scene.summary},
                    {"ticksPerStep", scene.description.ticksPerStep},
                    {"organs", organs}});
  }
  fmt::print("{}\n", json{{"scenes", list}}.dump(2));
}

}  // namespace

void addScenes(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("scenes", "List the scenes that can be simulated");
  const auto asJson = std::make_shared<bool>(false);
  command->add_flag("--json", *asJson, "Print JSON");
  command->callback([&run, asJson] {
    run = [asJson] {
      const std::vector<std::filesystem::path> files = recorder::listScenes(assetFolders());
      if (files.empty())
        throw Error(ExitCode::usage, "no scenes were found; set CALOT_ASSETS to the folder that holds \"scenes\"");
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
          if (fault.code() != ExitCode::damaged) throw;
          fmt::print(stderr, "calot: {}\n", fault.what());
          damaged = true;
        }
      }
      *asJson ? printJson(scenes) : printTable(scenes);
      return static_cast<int>(damaged ? ExitCode::damaged : ExitCode::yes);
    };
  });
}

}  // namespace calot::apps
