// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/replay_words.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/interchange/export_tables.h"
#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/recorded_columns.h"
#include "recorder/sources/column_map.h"

namespace calot::apps {

namespace {

struct ExportOptions {
  std::string file, folder, motion, columns, cohort;
  bool force = false;
};

void printFiles(const std::vector<std::filesystem::path>& files) {
  for (const auto& file : files) printText(file.string() + '\n');
}

void exportMotionFile(const ExportOptions& o) {
  if (!o.folder.empty() || !o.cohort.empty())
    throw Error(ErrorKind::invalid, Where{o.file},
                "is not a recording (.h5): of a motion file there is --motion alone");
  std::optional<recorder::ColumnMap> map;
  if (!o.columns.empty()) map = recorder::readColumnMap(o.columns);
  const recorder::TrackedMotion tracked = readMotion(o.file, map ? &*map : nullptr);
  printFiles(analytics::writeMotionTables({analytics::motionOf(tracked, 0), analytics::motionOf(tracked, 1)}, o.motion,
                                          o.force));
}

void exportRecording(const ExportOptions& o) {
  if (o.folder.empty() && o.motion.empty())
    throw Error(ErrorKind::invalid,
                "export: --csv FOLDER writes all that is recorded, --motion FOLDER filtered motion");
  if (!o.columns.empty()) throw Error(ErrorKind::invalid, "export: --columns is for motion files, not for recordings");
  Progress progress("Exporting", false, "steps");
  const recorder::ChainVerdict chain = recorder::probe(o.file);
  recorder::Recording recording(o.file);
  if (!o.cohort.empty())
    analytics::recordExport(o.cohort, "recording-csv", o.folder.empty() ? o.motion : o.folder,
                            {recording.header().attempt});
  if (!o.folder.empty()) {
    const std::uint64_t steps = recording.stepCount();
    const std::vector<std::filesystem::path> files = recorder::exportCsv(
        recording, o.folder, o.force, [&progress, steps](std::uint64_t done) { progress.show(done, steps); });
    printFiles(files);
  }
  if (!o.motion.empty()) printFiles(analytics::writeMotionTables(analytics::motionOf(recording), o.motion, o.force));
  if (!recording.complete()) printText("incomplete\n");
  // The export is complete; the exit code reports that the recording was changed.
  if (!chain.intact()) throw Error(ErrorKind::refused, fmt::format("{}: {}", o.file, analytics::wordsFor(chain)));
}

void exportFile(const ExportOptions& o) {
  const bool recorded = o.motion.empty() || std::filesystem::path(o.file).extension() == ".h5";
  return recorded ? exportRecording(o) : exportMotionFile(o);
}

}  // namespace

void addExport(CLI::App& app, Run& run) {
  const auto [command, o] =
      addCommand(app, run,
                 {"export", "Write a recording, or the motion in it, as tables for other programs",
                  "calot export attempt.h5 --csv tables", "calot export attempt.h5 --motion motion"},
                 exportFile);
  command->add_option("file", o->file, "Recording (.h5); with --motion also a motion file, as calot import reads")
      ->required();
  command->add_option("--csv", o->folder, "Folder for all that is recorded");
  CLI::Option* motion = command->add_option(
      "--motion", o->motion,
      "Folder for both hands' filtered motion with its segments and movements, as checkpoints see it");
  command->add_option("--columns", o->columns, "A JSON file that says what the columns of a CSV motion file are")
      ->needs(motion);
  command->add_option("--cohort", o->cohort, "Cohort database that notes that this was handed out");
  command->add_flag("--force", o->force, "Replace files that --csv finds there, or the folder of --motion");
}

}  // namespace calot::apps
