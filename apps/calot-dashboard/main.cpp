// SPDX-License-Identifier: GPL-3.0-or-later
// calot-dashboard: options, then the window.
#include <algorithm>
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <QApplication>
#include <QSize>
#include <string>
#include <vector>

#include "apps/calot-dashboard/assess_program.h"
#include "apps/calot-dashboard/opened_recording.h"
#include "apps/common/help_json.h"
#include "apps/common/program.h"
#include "apps/window/window_start.h"
#include "gui/attempt/theme.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/settings.h"
#include "recorder/base/errors.h"
#include "recorder/base/program_files.h"
#include "recorder/compliance_cache.h"
#include "recorder/kept/engine_folders.h"
#include "recorder/prepared_scene.h"

namespace {

constexpr const char* programName = "calot-dashboard";

int run(int argc, char** argv) {
  CLI::App options{"Shows the attempts and checkpoints of a cohort database, or a recording.", programName};
  options.footer("Example:\n  calot-dashboard c.db");
  std::string file, pictures, graphics = "auto";
  calot::apps::LookOptions look;
  options.set_version_flag("--version", "calot-dashboard " CALOT_VERSION);
  const CLI::Option* const given =
      options.add_option("file", file,
                         "Cohort database, as `calot assess --cohort` writes it; or a recording, which is verified, "
                         "assessed and kept in the cohort calot/opened.db of the user's data folder");
  options.add_option("--pictures", pictures, "Write a PNG of each page into this folder, and end");
  calot::apps::addLook(options, look, "as in the settings");
  calot::apps::addGraphics(options, graphics);
  calot::apps::addHelpJson(options);
  try {
    options.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return options.exit(error);
    return calot::apps::endWith(calot::apps::ExitCode::usage, programName, std::string(error.what()) + "; try --help");
  }

  calot::recorder::useComplianceCache(calot::recorder::userCacheFolder());
  // A file that cannot be opened is told before there is a window, and needs none.
  std::shared_ptr<const calot::gui::CohortDocument> document;
  std::optional<calot::apps::OpenedRecording> recording;
  if (given->count() > 0) recording = calot::apps::openedRecording(file);
  bool older = false;  // of an older schema, which the window brings up to date
  if (given->count() > 0 && !recording) {
    try {
      document = std::make_shared<const calot::gui::CohortDocument>(file);
    } catch (const calot::Error& error) {
      const std::vector<calot::Remedy>& remedies = error.remedies();
      older = std::find(remedies.begin(), remedies.end(), calot::Remedy::upgradeCohort) != remedies.end();
      if (!older) throw;
    }
  }
  if (recording && !pictures.empty())
    throw calot::Error(calot::ErrorKind::invalid, "--pictures: needs a cohort database, not a recording");
  const QSize asked = calot::apps::windowSize(look);
  if (!pictures.empty()) calot::apps::requireFolder(pictures, "pictures");
  calot::apps::requireScreen();
  calot::apps::useGraphics(graphics);

  QApplication application(argc, argv);
  QApplication::setApplicationName("Calot");
  calot::gui::theme::apply(look.colours.empty() ? calot::gui::settings::colours()
                                                : calot::gui::theme::choiceOf(QString::fromStdString(look.colours)),
                           look.type == 0 ? calot::gui::settings::type() : look.type);
  const calot::recorder::ProgramFiles files = calot::recorder::ProgramFiles::ofThisProgram();
  const std::vector<std::filesystem::path> assets = files.assetRoots();
  calot::recorder::useEngines(calot::recorder::userEnginePlaces(files.programs(), assets));
  calot::gui::DashboardWindow window(calot::apps::assessProgram(), assets);
  if (document) window.setDocument(document);
  if (!asked.isNull()) window.resize(asked);
  window.show();
  if (older) window.openDatabase(QString::fromStdString(file));
  if (recording && window.createDatabase(QString::fromStdString(calot::apps::openedCohort().string())))
    window.showRecording(QString::fromStdString(recording->file.string()), QString::fromStdString(recording->attempt));
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
