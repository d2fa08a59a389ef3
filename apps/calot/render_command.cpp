// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/checkpoints/replay_words.h"
#include "analytics/cohort/withdraw.h"
#include "apps/calot/command.h"
#include "gui/film/film.h"
#include "recorder/base/files.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"

namespace calot::apps {

namespace {

struct RenderOptions {
  std::string recording, output, cohort, size = "1280x720", quality, align, graphics = "software";
  std::optional<std::string> at, from, to, overlay, beside;
  double speed = 1.0;
  int fps = 25;
  bool force = false, anyway = false;
};

gui::Quality qualityOf(const std::string& word, bool film) {
  if (word.empty()) return film ? gui::Quality::interactive : gui::Quality::film;
  return word == "film" ? gui::Quality::film : gui::Quality::interactive;
}

/// A picture has one moment, a film two. @throws Error (invalid)
void refuseMixed(const RenderOptions& o, bool film) {
  if (film && o.at) throw Error(ErrorKind::invalid, "--at is for pictures; a film has --from and --to");
  if (!film && (o.from || o.to))
    throw Error(ErrorKind::invalid, "--from and --to are for films (.mp4, .mkv); a picture has --at");
  if (!o.beside && !o.align.empty()) throw Error(ErrorKind::invalid, "--align needs --beside");
}

void render(const RenderOptions& o) {
  const std::filesystem::path output(o.output);
  const bool film = output.extension() == ".mp4" || output.extension() == ".mkv";
  if (!film && output.extension() != ".png") {
    throw Error(ErrorKind::invalid,
                fmt::format("{}: pictures are written as .png, films as .mp4 or .mkv", output.string()));
  }
  recorder::refuseOutput(output, o.force);
  refuseMixed(o, film);
  gui::FilmSettings settings;
  settings.size = gui::parsePictureSize(o.size);
  settings.quality = qualityOf(o.quality, film);
  if (o.overlay) settings.overlays = gui::parseOverlays(*o.overlay);
  if (const std::optional<std::string>& from = film ? o.from : o.at; from) settings.from = parseTime(*from);
  if (o.to) settings.to = parseTime(*o.to);
  settings.graphics = gui::graphicsFrom(o.graphics);
  settings.speed = o.speed;
  settings.fps = o.fps;
  settings.alignment = o.align == "phase" ? gui::Alignment::phase : gui::Alignment::start;
  if (o.beside) settings.beside = *o.beside;
  settings.anyway = o.anyway;

  Progress progress("Rendering", false, "frames");
  std::vector<std::string> attempts;
  std::vector<std::string> files{o.recording};
  if (o.beside) files.push_back(*o.beside);
  for (const std::string& file : files) {
    if (const recorder::ChainVerdict chain = recorder::probe(file); !chain.intact()) {
      if (!o.anyway) throw Error(ErrorKind::refused, Where{file}, analytics::wordsFor(chain), {Remedy::replayAnyway});
      settings.doubt = "NOT AS RECORDED: content was changed";
    }
    if (!o.cohort.empty()) attempts.push_back(recorder::Recording(file).header().attempt);
  }
  if (film)
    gui::checkFilm(o.recording, output, settings);
  else
    gui::checkMoment(o.recording, settings);
  if (!o.cohort.empty()) analytics::recordExport(o.cohort, film ? "film" : "picture", o.output, attempts);
  if (!film) {
    const gui::ShownMoment shown = gui::writeMoment(o.recording, output, settings);
    Progress::erase();
    fmt::print("{}: step {}, {:.2f} s\n", o.output, shown.step, shown.seconds);
    return;
  }
  stopOnSignals();
  const std::int64_t frames = gui::writeFilm(o.recording, output, settings, [&](std::uint64_t done, std::uint64_t of) {
    if (stopRequested()) throw Error(ErrorKind::failure, o.output + ": stopped before its end; nothing is left of it");
    progress.show(done, of);
  });
  Progress::erase();
  fmt::print("{}: {} frames, {:.2f} s\n", o.output, frames, static_cast<double>(frames) / settings.fps);
}

}  // namespace

void addRender(CLI::App& app, Run& run) {
  const auto [command, o] = addCommand(app, run,
                                       {"render", "Draws a moment of a recording, or makes a film of it.",
                                        "calot render attempt.h5 --at 12.5 -o moment.png",
                                        "calot render attempt.h5 --from 10 --to 20 --overlay time,phase -o film.mp4"},
                                       render);
  command->add_option("recording", o->recording, "recording")->required();
  command->add_option("-o,--output", o->output, "picture (.png) or film (.mp4, .mkv)")->required();
  command->add_option("--at", o->at, "of a picture: seconds, or minutes:seconds (default: the start)");
  command->add_option("--from", o->from, "of a film: its first moment (default: the start)");
  command->add_option("--to", o->to, "of a film: its last moment (default: the end)");
  command->add_option("--fps", o->fps, "of a film: frames a second")->capture_default_str();
  command->add_option("--speed", o->speed, "of a film: recorded seconds in one of its seconds")->capture_default_str();
  command->add_option("--size", o->size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  command->add_option("--quality", o->quality, "film: all effects; interactive: fast (default: film for pictures)")
      ->check(oneOf({"film", "interactive"}));
  command
      ->add_option("--graphics", o->graphics,
                   "what draws: software (the same bytes each time), card, auto (a card where there is one)")
      ->check(oneOf(gui::graphicsWords()))
      ->capture_default_str();
  command->add_option("--overlay", o->overlay, "any of time,phase,checkpoints,events,tools");
  command->add_option("--beside", o->beside, "another recording, in the right half");
  command->add_option("--align", o->align, "with --beside: both from the start, or phase by phase")
      ->check(oneOf({"start", "phase"}));
  command->add_option("--cohort", o->cohort, "cohort database that notes the picture, for withdrawals");
  command->add_flag("--anyway", o->anyway,
                    "draw recordings of a simulation version without an engine, and changed ones, too: with a mark");
  command->add_flag("--force", o->force, "replace the output if it is there");
}

}  // namespace calot::apps
