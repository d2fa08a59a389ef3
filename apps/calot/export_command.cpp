// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <unistd.h>

#include <memory>
#include <string>

#include "analytics/cohort/withdraw.h"
#include "apps/calot/commands.h"
#include "apps/common/exit_code.h"
#include "recorder/errors.h"
#include "recorder/recording/export_csv.h"

namespace calot::apps {

void addExport(CLI::App& app, Run& run) {
  struct Options {
    std::string file, folder, cohort;
    bool force = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("export", "Write a recording as CSV files");
  command->add_option("recording", options->file, "Recording (.h5)")->required();
  command->add_option("--csv", options->folder, "Folder to write to")->required();
  command->add_option("--cohort", options->cohort, "Cohort database that notes that this was handed out");
  command->add_flag("--force", options->force, "Replace files that are there");
  command->callback([options, &run] {
    run = [options] {
      const recorder::ChainVerdict chain = recorder::probe(options->file);
      recorder::Recording recording(options->file);
      if (!options->cohort.empty())
        analytics::recordExport(options->cohort, "recording-csv", options->folder, {recording.header().attempt});
      const bool terminal = ::isatty(STDERR_FILENO) != 0;
      const std::uint64_t steps = recording.stepCount();
      const auto progress = [terminal, steps](std::uint64_t done) {
        if (terminal && (done % 1000 == 0 || done == steps))
          fmt::print(stderr, "\r{} of {} steps{}", done, steps, done == steps ? "\n" : "");
      };
      const auto files = recorder::exportCsv(recording, options->folder, options->force, progress);
      for (const auto& file : files) fmt::print("{}\n", file.string());
      if (!recording.complete()) fmt::print("incomplete\n");
      // What was asked for is there; that it was changed since it was recorded is the answer.
      if (!chain.intact) throw Error(ErrorKind::refused, fmt::format("{}: {}", options->file, chain.what));
      return static_cast<int>(ExitCode::yes);
    };
  });
}

}  // namespace calot::apps
