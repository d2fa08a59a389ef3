// SPDX-License-Identifier: GPL-3.0-or-later
// calot-dashboard: options, then the window.
#include <algorithm>
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <QApplication>
#include <QSize>
#include <QStringList>
#include <string>
#include <vector>

#include "apps/calot-dashboard/assess_program.h"
#include "apps/calot-dashboard/opened_recording.h"
#include "apps/common/help_json.h"
#include "apps/common/program.h"
#include "apps/window/start_checks.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/settings.h"
#include "gui/dashboard/theme.h"
#include "recorder/compliance_cache.h"
#include "recorder/errors.h"
#include "recorder/formats/program_files.h"
#include "recorder/formats/text_words.h"
#include "recorder/kept/engine_folders.h"
#include "recorder/prepared_scene.h"

namespace {

constexpr const char* programName = "calot-dashboard";

/// @throws calot::Error (invalid)
QSize windowSize(const std::string& text) {
  constexpr int least = 640, most = 8192;
  const QStringList parts = QString::fromStdString(text).split('x');
  bool known[2] = {false, false};
  const QSize size(parts[0].toInt(&known[0]), parts.size() == 2 ? parts[1].toInt(&known[1]) : 0);
  if (!known[0] || !known[1] || std::min(size.width(), size.height()) < least || size.width() > most ||
      size.height() > most)
    throw calot::Error(calot::ErrorKind::invalid,
                       "--size " + calot::recorder::shown(text) + ": WIDTHxHEIGHT is wanted, of 640 to 8192 pixels");
  return size;
}

int run(int argc, char** argv) {
  CLI::App options{"Shows the attempts and checkpoints of a cohort database, or a recording.", programName};
  options.footer("Example:\n  calot-dashboard c.db");
  std::string file, pictures, graphics = "auto", colours, size;
  int type = 0;
  options.set_version_flag("--version", "calot-dashboard " CALOT_VERSION);
  const CLI::Option* const given =
      options.add_option("file", file,
                         "Cohort database, as `calot assess --cohort` writes it; or a recording, which is verified, "
                         "assessed and kept in the cohort calot/opened.db of the user's data folder");
  options.add_option("--pictures", pictures, "Write a PNG of each page into this folder, and end");
  options.add_option("--colours", colours, "light, dark, or system; default: as in the settings")
      ->check(CLI::IsMember({"system", "light", "dark"}));
  options.add_option("--type", type, "Size of letters in per cent of the system's; default: as in the settings")
      ->check(CLI::Range(calot::gui::theme::usualType, calot::gui::theme::largestType));
  options.add_option("--size", size, "WIDTHxHEIGHT of the window in pixels; default: most of the screen");
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
  const QSize asked = size.empty() ? QSize() : windowSize(size);
  if (!pictures.empty()) calot::apps::requireFolder(pictures, "pictures");
  calot::apps::requireScreen();
  calot::apps::useGraphics(graphics);

  QApplication application(argc, argv);
  QApplication::setApplicationName("Calot");
  calot::gui::theme::apply(
      colours.empty() ? calot::gui::settings::colours() : calot::gui::theme::choiceOf(QString::fromStdString(colours)),
      type == 0 ? calot::gui::settings::type() : type);
  const calot::recorder::ProgramFiles files = calot::recorder::ProgramFiles::ofThisProgram();
  const std::vector<std::filesystem::path> assets = files.assetRoots();
  calot::recorder::useEngines(calot::recorder::userEnginePlaces(files.programs(), assets));
  calot::gui::DashboardWindow window(calot::apps::assessProgram(), assets);
  if (document) window.setDocument(document);
  if (!size.empty()) window.resize(asked);
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
