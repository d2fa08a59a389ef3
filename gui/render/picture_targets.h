// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "gui/render/render_target.h"
#include "gui/render/renderer.h"

namespace calot::gui {

/// What the passes of a picture of one size and quality draw on.
struct PictureTargets {
  /// @throws calot::Error (failure) if there is no memory for them.
  PictureTargets(const GlFunctions& gl, int width, int height, Quality quality);

  int width, height;
  Quality quality;
  RenderTarget shadow;
  RenderTarget prepass;                    ///< depth and normals; interactive: at half the size
  RenderTarget open, smoothed;             ///< occlusion: with normals; smoothed
  RenderTarget radiance;                   ///< film: linear light; interactive: the picture itself, upside down
  std::unique_ptr<RenderTarget> picture;   ///< film
  std::unique_ptr<RenderTarget> backdrop;  ///< interactive: the cavity alone, at half the size
};

}  // namespace calot::gui
