// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "gui/film/lettering.h"
#include "gui/film/moment_track.h"
#include "gui/render/image.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// Text and marks drawn over a frame.
struct Overlays {
  bool time = false, phase = false, checkpoints = false, events = false, tools = false;

  /// Some of them need what the steps recorded of themselves.
  [[nodiscard]] bool needTrack() const { return phase || checkpoints || events || tools; }
};

/// "time,phase". @throws calot::Error (invalid) naming what is not known
[[nodiscard]] Overlays parseOverlays(const std::string& text);

/// Titles and marks shown on every frame.
struct Captions {
  std::string title;       ///< at the upper edge; truncated if too long
  std::string mark;        ///< at the lower edge: a non-human operator ("synthetic")
  std::string doubt = {};  ///< in the middle of the upper half, in amber: what is shown is not what was recorded
};

/// Draws overlays in sizes that fit the picture's height: time and phase in the upper left corner, checkpoints in the
/// upper right, below a title, events in the lower left, above a mark that leaves no room beside it; the path of each
/// tool's tip over the last seconds as the camera sees it.
class OverlayPainter {
 public:
  explicit OverlayPainter(int pictureHeight);

  /// @param view what the picture shows: its camera places the paths
  void paint(Image& image, const Overlays& overlays, const Moment& moment, const SceneView& view,
             const Captions& captions = {}) const;

 private:
  void paintTitle(Image& image, std::string title) const;
  void paintDoubt(Image& image, const std::string& doubt) const;
  void paintEvents(Image& image, const Moment& moment, int bottom) const;

  Lettering letters_;
  int margin_;
};

}  // namespace calot::gui
