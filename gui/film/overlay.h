// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "gui/film/lettering.h"
#include "gui/film/moment_track.h"
#include "gui/render/image.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// What is written or drawn over a picture.
struct Overlays {
  bool time = false, phase = false, checkpoints = false, events = false, tools = false;

  /// Some of them need what the steps recorded of themselves.
  [[nodiscard]] bool needTrack() const { return phase || checkpoints || events || tools; }
};

/// "time,phase". @throws calot::Error (usage) naming what is not known
[[nodiscard]] Overlays parseOverlays(const std::string& text);

/// Draws overlays in sizes that fit the picture's height: time and phase in the upper left corner, checkpoints in the
/// upper right, events in the lower left; the path of each tool's tip over the last seconds as the camera sees it.
class OverlayPainter {
 public:
  explicit OverlayPainter(int pictureHeight);

  /// @param view what the picture shows: its camera places the paths
  void paint(Image& image, const Overlays& overlays, const Moment& moment, const SceneView& view) const;
  /// A mark across the lower edge that says who acted where that is no person ("synthetic").
  void mark(Image& image, const std::string& text) const;
  /// A title above a picture.
  void title(Image& image, const std::string& text) const;

 private:
  Lettering letters_;
  int margin_;
};

}  // namespace calot::gui
