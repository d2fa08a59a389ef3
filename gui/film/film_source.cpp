// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/film_source.h"

#include <algorithm>
#include <cmath>

namespace calot::gui {

FilmSource::FilmSource(const std::filesystem::path& recording, const Overlays& overlays)
    : recording_(recording), seeker_(recording_) {
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
