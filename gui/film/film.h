// SPDX-License-Identifier: GPL-3.0-or-later
// A recording as a film, or a moment of it as a picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "gui/film/overlay.h"
#include "gui/render/image.h"
#include "gui/render/renderer.h"

namespace calot::gui {

/// How a second recording is synchronised: both from their starts, or each phase of the procedure stretched to
/// that of the first.
enum class Alignment { start, phase };

struct FilmSettings {
  double from = 0.0;                       ///< s
  std::optional<double> to;                ///< s; none: the end
  double speed = 1.0;                      ///< recorded seconds per second of film, 0.01 to 100
  int fps = 25;                            ///< frames per second
  PictureSize size;                        ///< of the whole film
  Quality quality = Quality::interactive;  ///< of its pictures
  Graphics graphics = Graphics::software;  ///< what draws them: software draws the same bytes each time
  Overlays overlays;
  std::optional<std::filesystem::path> beside;  ///< a second recording, in the right half
  Alignment alignment = Alignment::start;
  bool blinded = false;  ///< the mark of a synthetic attempt does not name its profile
  /// Draws what this program makes of recordings that it cannot decide, or that differ, too: each frame has a mark
  /// then.
  bool anyway = false;
  std::string doubt;  ///< a mark for every frame, where what is recorded is in doubt itself
};

/// Checks the arguments of the functions below, before anything is done.
/// @throws calot::Error: invalid for settings out of range; damaged where a recording cannot be read or holds no step;
/// undecided where no engine of a recording's simulation version is here, if not `anyway`
void checkFilm(const std::filesystem::path& recording, const std::filesystem::path& output,
               const FilmSettings& settings);
void checkMoment(const std::filesystem::path& recording, const FilmSettings& settings);

/// Writes a film. Frame k shows the recording at from + k speed / fps, after the step that begins then. One thread
/// simulates ahead, another renders ahead, the calling one encodes. Films of synthetic or other non-human attempts
/// are marked as such.
/// @param output .mp4 or .mkv; replaced if it exists
/// @param progress called after every frame; an exception from it stops the film
/// @return the number of pictures
/// @throws calot::Error: as checkFilm(); refused where re-simulation comes to another State than was recorded, if not
/// `anyway`; failure where the film cannot be written. Nothing is left behind then.
std::int64_t writeFilm(const std::filesystem::path& recording, const std::filesystem::path& output,
                       const FilmSettings& settings,
                       const std::function<void(std::uint64_t done, std::uint64_t of)>& progress = {});

/// Content of a frame.
struct ShownMoment {
  std::uint64_t step = 0;
  double seconds = 0.0;  ///< at the step's end
};

/// Writes the moment `from` of a recording as a PNG, with the same overlays and marks.
/// @throws calot::Error as writeFilm()
ShownMoment writeMoment(const std::filesystem::path& recording, const std::filesystem::path& output,
                        const FilmSettings& settings);

/// Writes the doublet of a recording's critical view (docs/how-to/ratings.md) as one PNG: left the endoscope's view,
/// right the same place from the patient's right, both before the step at which the judge scored the view, that of the
/// first clip, and without the instrument that set it. None, and nothing is written, where no clip was set.
/// @throws calot::Error as writeFilm()
std::optional<ShownMoment> writeDoublet(const std::filesystem::path& recording, const std::filesystem::path& output,
                                        const FilmSettings& settings);

}  // namespace calot::gui
