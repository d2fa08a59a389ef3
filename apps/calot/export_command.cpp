// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analytics/checkpoints/from_samples.h"
#include "analytics/checkpoints/recorded_motion.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/interchange/motion_tables.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/motion_import.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"
#include "recorder/recording/export_csv.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/probe.h"
#include "recorder/sources/column_map.h"

namespace calot::apps {

namespace {

struct ExportOptions {
  std::string file, folder, motion, columns, cohort;
  bool force = false;
};

void printFiles(const std::vector<std::filesystem::path>& files) {
  for (const auto& file : files) fmt::print("{}\n", file.string());
}

int exportMotionFile(const ExportOptions& o) {
  if (!o.folder.empty() || !o.cohort.empty())
    throw Error(ErrorKind::invalid, Where{o.file}, "is no recording (.h5): of a motion file there is --motion alone");
  std::optional<recorder::ColumnMap> map;
  if (!o.columns.empty()) map = recorder::readColumnMap(o.columns);
  const recorder::TrackedMotion tracked = readMotion(o.file, map ? &*map : nullptr);
  printFiles(analytics::writeMotionTables({analytics::motionOf(tracked, 0), analytics::motionOf(tracked, 1)}, o.motion,
                                          o.force));
  return static_cast<int>(ExitCode::yes);
}

int exportRecording(const ExportOptions& o) {
  if (o.folder.empty() && o.motion.empty())
    throw Error(ErrorKind::invalid,
                "export: --csv FOLDER writes all that is recorded, --motion FOLDER filtered motion");
  if (!o.columns.empty()) throw Error(ErrorKind::invalid, "export: --columns is for motion files, not for recordings");
  const recorder::ChainVerdict chain = recorder::probe(o.file);
  recorder::Recording recording(o.file);
  if (!o.cohort.empty())
    analytics::recordExport(o.cohort, "recording-csv", o.folder.empty() ? o.motion : o.folder,
                            {recording.header().attempt});
  if (!o.folder.empty()) {
    Progress progress("exporting, steps");
    const std::uint64_t steps = recording.stepCount();
    const std::vector<std::filesystem::path> files = recorder::exportCsv(
        recording, o.folder, o.force, [&progress, steps](std::uint64_t done) { progress.show(done, steps); });
    Progress::erase();
    printFiles(files);
  }
  if (!o.motion.empty()) printFiles(analytics::writeMotionTables(analytics::motionOf(recording), o.motion, o.force));
  if (!recording.complete()) fmt::print("incomplete\n");
  // What was asked for is there; that it was changed since it was recorded is the answer.
  if (!chain.intact) throw Error(ErrorKind::refused, fmt::format("{}: {}", o.file, chain.what));
  return static_cast<int>(ExitCode::yes);
}

}  // namespace

void addExport(CLI::App& app, Run& run) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* command =
      app.add_subcommand("export", "Write a recording, or the motion in it, as tables for other programs");
  command->add_option("file", options->file, "Recording (.h5); with --motion also a motion file, as calot import reads")
      ->required();
  command->add_option("--csv", options->folder, "Folder for all that is recorded");
  CLI::Option* motion = command->add_option(
      "--motion", options->motion,
      "Folder for both hands' filtered motion with its segments and movements, as checkpoints see it");
  command->add_option("--columns", options->columns, "A JSON file that says what the columns of a CSV motion file are")
      ->needs(motion);
  command->add_option("--cohort", options->cohort, "Cohort database that notes that this was handed out");
  command->add_flag("--force", options->force, "Replace files that --csv finds there, or the folder of --motion");
  command->callback([options, &run] {
    run = [options] {
      const bool recorded = options->motion.empty() || std::filesystem::path(options->file).extension() == ".h5";
      return recorded ? exportRecording(*options) : exportMotionFile(*options);
    };
  });
}

}  // namespace calot::apps
