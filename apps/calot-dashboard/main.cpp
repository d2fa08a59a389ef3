// SPDX-License-Identifier: GPL-3.0-or-later
// calot-dashboard: options, then the window.
#include <algorithm>
#include <array>
#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <QApplication>
#include <QSize>
#include <QStandardPaths>
#include <QTimer>
#include <string>
#include <system_error>
#include <vector>

#include "apps/calot-dashboard/assess_program.h"
#include "apps/common/program.h"
#include "apps/window/window_start.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/dialogs.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/compliance_cache.h"
#include "recorder/kept/kept_engine.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"

namespace calot::apps {
namespace {

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
  if (fault) throw Error(ErrorKind::failure, Where{folder.string()}, "the folder cannot be made: " + fault.message());
  return folder / "opened.db";
}

struct Options {
  std::optional<std::string> file;
  std::string pictures, graphics = "auto";
  LookOptions look;
};

int run(const Options& o, int argc, char** argv) {
  recorder::useComplianceCache(recorder::userCacheFolder());
  // A file that cannot be opened is reported before there is a window, and needs none.
  std::shared_ptr<const gui::CohortDocument> document;
  const bool recording = o.file && isRecording(*o.file);
  std::string attempt;  // uuid of the recording's
  if (recording) {
    recorder::probe(*o.file);
    attempt = recorder::Recording(*o.file).header().attempt;
  }
  bool older = false;  // of an older schema, which the window brings up to date
  if (o.file && !recording) {
    try {
      document = std::make_shared<const gui::CohortDocument>(*o.file);
    } catch (const Error& error) {
      const std::vector<Remedy>& remedies = error.remedies();
      older = std::find(remedies.begin(), remedies.end(), Remedy::upgradeCohort) != remedies.end();
      if (!older) throw;
    }
  }
  if (recording && !o.pictures.empty())
    throw Error(ErrorKind::invalid, "--pictures: needs a cohort database, not a recording");
  const std::optional<QSize> asked = windowSize(o.look);
  if (!o.pictures.empty()) requireFolder(o.pictures, "pictures");
  const recorder::ProbeProcesses probes(2, true);  // while this process is small
  const std::unique_ptr<QApplication> application = openScreen(argc, argv);
  useGraphics(o.graphics);
  gui::theme::apply(
      o.look.colours.empty() ? gui::settings::colours() : gui::theme::choiceOf(QString::fromStdString(o.look.colours)),
      o.look.type == 0 ? gui::settings::type() : o.look.type);
  const recorder::ProgramFiles files = recorder::ProgramFiles::ofThisProgram();
  const std::vector<fs::path> assets = files.assetRoots();
  recorder::useEngines(recorder::userEnginePlaces(files.programs(), assets));
  gui::DashboardWindow window(assessProgram(), assets);
  if (document) window.setDocument(document);
  if (asked) window.resize(*asked);
  window.show();
  if (older) window.openDatabase(QString::fromStdString(*o.file));
  if (recording && window.createDatabase(QString::fromStdString(openedCohort().string())))
    window.showRecording(QString::fromStdString(fs::absolute(*o.file).string()), QString::fromStdString(attempt));
  if (!o.pictures.empty()) {
    window.savePictures(QString::fromLocal8Bit(o.pictures.c_str()));
    return 0;
  }
  constexpr int idle = 400;  // ms after which nothing else is being done
  QTimer::singleShot(idle, &window, &gui::DashboardWindow::prepare);
  return QApplication::exec();
}

}  // namespace
}  // namespace calot::apps

int main(int argc, char** argv) {
  CLI::App app{"Shows the attempts and checkpoints of a cohort database, or a recording.", "calot-dashboard"};
  app.footer("Example:\n  calot-dashboard c.db");
  app.set_version_flag("--version", "calot-dashboard " CALOT_VERSION);
  calot::apps::Options o;
  app.add_option("file", o.file,
                 "Cohort database, as `calot assess --cohort` writes it; or a recording, which is verified, "
                 "assessed and kept in the cohort calot/opened.db of the user's data folder");
  app.add_option("--pictures", o.pictures, "Write a PNG of each page into this folder, and end");
  calot::apps::addLook(app, o.look, "as in the settings");
  calot::apps::addGraphics(app, o.graphics);
  return calot::apps::runProgram(app, argc, argv, [&] { return calot::apps::run(o, argc, argv); });
}
