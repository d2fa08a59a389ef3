// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>
#include <string>

#include "apps/calot/commands.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"
#include "recorder/recording/recover.h"

namespace calot::apps {

void addRecover(CLI::App& app, Run& run) {
  struct Options {
    std::string in, out;
    bool force = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("recover", "Rewrite a recording that was cut off or whose writer was killed");
  command->add_option("recording", options->in, "Recording (.h5)")->required();
  command->add_option("-o,--output", options->out, "File to write")->required();
  command->add_flag("--force", options->force, "Replace the output if it is there");
  command->callback([options, &run] {
    run = [options] {
      const recorder::Recovered saved = recorder::recover(options->in, options->out, options->force);
      fmt::print("{}: {} steps, {} ticks saved, {}\n", options->out, saved.steps, saved.ticks,
                 saved.complete ? "complete" : "incomplete");
      if (!saved.lost.empty()) fmt::print("the rest is lost: {}\n", saved.lost);
      return static_cast<int>(ExitCode::yes);
    };
  });
}

}  // namespace calot::apps
