// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>

#include "analytics/cohort/withdraw.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "gui/render/picture.h"
#include "recorder/errors.h"
#include "recorder/live/worker_pool.h"
#include "recorder/replay.h"

namespace calot::apps {

namespace {

struct Options {
  std::string recording, output, cohort, at = "0", size = "1280x720";
  bool force = false;
};

int render(const Options& o) {
  const std::filesystem::path output(o.output);
  if (output.extension() != ".png") {
    throw Error(ExitCode::usage, fmt::format("{}: pictures are written as .png", o.output));
  }
  refuseExisting(output, o.force);
  const gui::PictureSize size = gui::parsePictureSize(o.size);
  const double time = parseTime(o.at);
  recorder::probe(o.recording);
  recorder::Recording recording(o.recording);
  if (recording.stepCount() == 0) throw Error(ExitCode::damaged, fmt::format("{}: holds no step to draw", o.recording));
  const double seconds = recording.seconds();
  if (time > seconds) {
    throw Error(ExitCode::usage,
                fmt::format("{}: is {:.2f} s long, there is nothing at {:.2f} s", o.recording, seconds, time));
  }
  const double step = seconds / static_cast<double>(recording.stepCount());
  const auto n = std::min(static_cast<std::uint64_t>(std::floor(time / step)), recording.stepCount() - 1);
  if (!o.cohort.empty()) analytics::recordExport(o.cohort, "picture", o.output, {recording.header().attempt});
  recorder::WorkerPool pool(1);
  recorder::Seeker seeker(recording, pool);
  seeker.seek(n);
  gui::writePicture(seeker.session().view(), size, output);
  fmt::print("{}: step {}, {:.2f} s\n", o.output, n, static_cast<double>(n + 1) * step);
  return 0;
}

}  // namespace

void addRender(CLI::App& app, Run& run) {
  auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("render", "Draws a moment of a recording.");
  command->add_option("recording", o->recording, "recording")->required();
  command->add_option("-o,--output", o->output, "picture (.png)")->required();
  command->add_option("--at", o->at, "time: seconds, or minutes:seconds")->capture_default_str();
  command->add_option("--size", o->size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  command->add_option("--cohort", o->cohort, "cohort database that notes the picture, for withdrawals");
  command->add_flag("--force", o->force, "replace the output if it is there");
  command->callback([o, &run] { run = [o] { return render(*o); }; });
}

}  // namespace calot::apps
