// SPDX-License-Identifier: GPL-3.0-or-later
// calot-dashboard: options, then the window.
#include <algorithm>
#include <array>
#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <memory>
#include <QApplication>
#include <QSize>
#include <QStandardPaths>
#include <string>
#include <system_error>
#include <vector>

#include "apps/calot-dashboard/assess_program.h"
#include "apps/common/help_json.h"
#include "apps/common/program.h"
#include "apps/window/window_start.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/dialogs.h"
#include "recorder/base/errors.h"
#include "recorder/base/program_files.h"
#include "recorder/compliance_cache.h"
#include "recorder/kept/engine_folders.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"

namespace {

constexpr const char* programName = "calot-dashboard";

namespace fs = std::filesystem;

/// False where the file does not begin as a recording does: then it may be a cohort.
bool isRecording(const fs::path& file) {
  constexpr std::array<char, 8> signature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  std::array<char, 8> head{};
  std::ifstream in(file, std::ios::binary);
  return in.read(head.data(), head.size()) && head == signature;
}

/// The cohort of recordings that are opened by themselves, as a file manager hands them over: `calot/opened.db` in the
/// user's data folder, which is made where it is missing. @throws Error (failure) where there can be none
fs::path openedCohort() {
  const fs::path folder =
      fs::path(QStandardPaths::writableLocation(QStandardPaths::GenericDataLocation).toStdString()) / "calot";
  std::error_code fault;
  fs::create_directories(folder, fault);
  if (fault)
    throw calot::Error(calot::ErrorKind::failure, calot::Where{folder.string()},
                       "the folder cannot be made: " + fault.message());
  return folder / "opened.db";
}

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
  // A file that cannot be opened is reported before there is a window, and needs none.
  std::shared_ptr<const calot::gui::CohortDocument> document;
  const bool recording = given->count() > 0 && isRecording(file);
  std::string attempt;  // uuid of the recording's
  if (recording) {
    calot::recorder::probe(file);
    attempt = calot::recorder::Recording(file).header().attempt;
  }
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
  const std::vector<fs::path> assets = files.assetRoots();
  calot::recorder::useEngines(calot::recorder::userEnginePlaces(files.programs(), assets));
  calot::gui::DashboardWindow window(calot::apps::assessProgram(), assets);
  if (document) window.setDocument(document);
  if (!asked.isNull()) window.resize(asked);
  window.show();
  if (older) window.openDatabase(QString::fromStdString(file));
  if (recording && window.createDatabase(QString::fromStdString(openedCohort().string())))
    window.showRecording(QString::fromStdString(fs::absolute(file).string()), QString::fromStdString(attempt));
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
