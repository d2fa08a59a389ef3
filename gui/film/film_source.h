// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "gui/film/moment_track.h"
#include "gui/film/overlay.h"
#include "recorder/replay.h"

namespace calot::gui {

/// Views of one recording in ascending order of time, re-simulated from the nearest keyframe or from the previous view.
class FilmSource {
 public:
  struct Scene {
    SceneView view;
    Moment moment;
    std::string doubt;  ///< why it is not what was recorded, for a mark; or empty
  };

  /// @pre the recording holds a step
  /// @param anyway shows what this program makes of a recording that it cannot decide, too, or that differs
  /// @throws calot::Error: damaged where the file cannot be read, or its scene cannot be built; invalid where an
  /// overlay needs what a golden recording has not; undecided where no engine of its version is here and `anyway` is
  /// not set
  FilmSource(const std::filesystem::path& recording, const Overlays& overlays, bool anyway = false);

  [[nodiscard]] double seconds() const { return recording_.seconds(); }
  [[nodiscard]] double stepSeconds() const;
  /// The step that shows a time: the one that begins there, the last one at the end. @pre 0 <= time <= seconds()
  [[nodiscard]] std::uint64_t stepAt(double time) const;
  /// After a step. @pre step < stepCount, and not before that of the last call @throws calot::Error: damaged; refused
  /// where re-simulation comes to another State than was recorded and `anyway` is not set
  [[nodiscard]] Scene at(std::uint64_t step);

  /// "synthetic: performer skilled", "kinematics", or empty for a human operator.
  /// @param blinded "synthetic" alone, without the profile
  [[nodiscard]] std::string mark(bool blinded) const;
  /// Operator for a title: pseudonym or kind of operator.
  [[nodiscard]] std::string title() const;

 private:
  recorder::Recording recording_;
  bool anyway_;
  bool foreign_;  ///< this program shows what another version recorded
  recorder::Seeker seeker_;
  std::unique_ptr<MomentTrack> track_;
};

}  // namespace calot::gui
