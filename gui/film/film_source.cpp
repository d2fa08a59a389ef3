// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/film_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "recorder/base/errors.h"
#include "recorder/kept/engine_folders.h"
#include "recorder/prepared_scene.h"
#include "sim/scene/version.h"

namespace calot::gui {

namespace {

/// The engine of a recording's version goes before this program's own, which shows another operation.
bool isForeign(const recorder::Recording& recording) {
  const std::uint32_t version = recording.header().simulationVersion;
  return version != simulationVersion && recorder::commandOfEngine(version).empty();
}

}  // namespace

FilmSource::FilmSource(const std::filesystem::path& recording, const Overlays& overlays, bool anyway)
    : recording_(recording),
      anyway_(anyway),
      foreign_(isForeign(recording_)),
      seeker_(recording_, recorder::EngineChoice(recording_, {.anyway = anyway && foreign_})) {
  if (overlays.needTrack() || hasResults(recording_))
    track_ = std::make_unique<MomentTrack>(recording, overlays.checkpoints);
}

double FilmSource::stepSeconds() const { return recording_.header().tickSeconds * recording_.header().ticksPerStep; }

std::uint64_t FilmSource::stepAt(double time) const {
  // Times are multiples of a frame's: a rounding error must not show the step before.
  const double step = std::floor(time / stepSeconds() + 1e-6);
  return std::min(static_cast<std::uint64_t>(std::max(step, 0.0)), recording_.stepCount() - 1);
}

FilmSource::Scene FilmSource::at(std::uint64_t step) {
  seeker_.seek(step);
  Scene scene;
  scene.view = seeker_.view();
  if (foreign_) {
    scene.doubt = fmt::format("NOT AS RECORDED: by version {}, shown by {}", recording_.header().simulationVersion,
                              simulationVersion);
  } else if (const auto& differs = seeker_.differsFrom()) {
    if (!anyway_)
      throw Error(ErrorKind::refused, Where{recording_.path().string()},
                  fmt::format("diverged at step {}: from there on another operation would be shown", *differs),
                  {Remedy::replayAnyway});
    scene.doubt = fmt::format("NOT AS RECORDED: differs from step {} on", *differs);
  }
  if (track_)
    scene.moment = track_->at(step);
  else
    scene.moment.time = static_cast<double>(step + 1) * stepSeconds();
  return scene;
}

std::string FilmSource::mark(bool blinded) const {
  const recorder::Provenance& source = recording_.header().provenance;
  switch (source.kind) {
    case recorder::OperatorKind::human:
      return "";
    case recorder::OperatorKind::kinematics:
      return "from recorded kinematics";
    case recorder::OperatorKind::performer:
      return blinded ? "synthetic" : "synthetic: performer " + source.profile;
  }
  return "";
}

std::string FilmSource::title() const {
  const recorder::AttemptHeader& header = recording_.header();
  return header.participant.empty() ? recording_.path().stem().string() : header.participant;
}

}  // namespace calot::gui
