// SPDX-License-Identifier: GPL-3.0-or-later
// calot-dashboard: options, then the window.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <QApplication>
#include <string>

#include "apps/calot-dashboard/assess_program.h"
#include "apps/common/program.h"
#include "apps/window/start_checks.h"
#include "gui/dashboard/dashboard_window.h"
#include "recorder/compliance_cache.h"
#include "recorder/formats/scene_file.h"
#include "recorder/kept/engine_folders.h"
#include "recorder/prepared_scene.h"

namespace {

constexpr const char* programName = "calot-dashboard";

int run(int argc, char** argv) {
  CLI::App options{"Shows the attempts and checkpoints of a cohort database."};
  options.footer("Example:\n  calot-dashboard c.db");
  std::string database, pictures;
  options.set_version_flag("--version", "calot-dashboard " CALOT_VERSION);
  const CLI::Option* const given =
      options.add_option("database", database, "Cohort database, as `calot assess --cohort` writes it");
  options.add_option("--pictures", pictures, "Write a PNG of each page into this folder, and end");
  try {
    options.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return options.exit(error);
    return calot::apps::endWith(calot::apps::ExitCode::usage, programName, std::string(error.what()) + "; try --help");
  }

  calot::recorder::useComplianceCache(calot::recorder::userCacheFolder());
  // A file that cannot be opened is told before there is a window, and needs none.
  std::shared_ptr<const calot::gui::CohortDocument> document;
  if (given->count() > 0) document = std::make_shared<const calot::gui::CohortDocument>(database);
  if (!pictures.empty()) calot::apps::requireFolder(pictures, "pictures");
  calot::apps::requireScreen();

  QApplication application(argc, argv);
  QApplication::setApplicationName("Calot");
  const std::filesystem::path program = QCoreApplication::applicationDirPath().toStdString();
  const std::vector<std::filesystem::path> assets = calot::recorder::assetRoots(program, CALOT_ASSETS);
  calot::recorder::useEngines(calot::recorder::userEnginePlaces(program, assets));
  calot::gui::DashboardWindow window(calot::apps::assessProgram(), assets);
  if (document) window.setDocument(document);
  window.show();
  if (!pictures.empty()) {
    window.savePictures(QString::fromLocal8Bit(pictures.c_str()));
    return 0;
  }
  return QApplication::exec();
}

}  // namespace

int main(int argc, char** argv) {
  return calot::apps::runProgram(programName, [&] { return run(argc, argv); });
}
