// SPDX-License-Identifier: GPL-3.0-or-later
// Scene view to pixels, off screen. The renderer depends only on SceneView, so that film, trainer and dashboard share
// it and a picture can never change a simulation.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "gui/render/graphics.h"
#include "gui/render/image.h"
#include "gui/render/translucent.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// interactive: one sample a pixel, smoothed edges, coarse occlusion; film: four samples a pixel, fine occlusion, soft
/// shadow.
enum class Quality { interactive, film };

/// Surroundings drawn around the scene.
struct RenderSettings {
  Quality quality = Quality::film;
  bool endoscopeMask = true;  ///< the round field of an endoscope with its vignetting, black outside
  bool cavity = true;         ///< the abdominal wall behind everything; without it, alpha is 0 where nothing was drawn
  bool ready = false;         ///< with the first picture, programs for all that may come are made: no later one waits
};

inline constexpr int minSide = 16;                     ///< of a picture (pixels)
inline constexpr int maxSide = 4096;                   ///< of a picture (pixels)
inline constexpr long long maxPixels = 3840LL * 2160;  ///< width times height

/// Draws scene views. Owns a thread with an OpenGL context of its own: a software context on the thread of a window
/// system corrupts that window system's. One picture at a time; calls from several threads wait for each other. The
/// same view gives the same bytes in software, in every run and with any number of threads of the machine; other CPUs
/// may differ by one level in a few channels, cards by some levels.
class Renderer {
 public:
  /// @throws calot::Error (failure) if this machine has no such OpenGL 4.5 off screen.
  explicit Renderer(Graphics graphics = Graphics::software);
  ~Renderer();

  /// Pinhole camera of view.camera: a point p_C = (x, y, z) of the camera's frame with z > 0 falls on the pixel
  ///   (width / 2 + f x / z, height / 2 + f y / z),  f = (height / 2) / tan(verticalFieldOfView / 2).
  /// @throws calot::Error: invalid if the size is outside the limits above; damaged if the view has a number that is
  /// not finite, a triangle that names no vertex, a sheet that names no strand, a strand without condition or with an
  /// alpha outside [0, 1], an invalid puff, or a field of view outside (0.05, 3.0) rad; failure if there is no
  /// memory.
  /// @param smoke what a view knows nothing of (SmokeTrail); drawn over the rest
  [[nodiscard]] Image render(const SceneView& view, int width, int height, const RenderSettings& settings = {},
                             std::span<const Puff> smoke = {});
  [[nodiscard]] Image render(const SceneView& view, int width, int height, Quality quality) {
    return render(view, width, height, RenderSettings{.quality = quality});
  }
  /// Description of the renderer: "OSMesa, llvmpipe (LLVM 15.0.6, 256 bits)".
  [[nodiscard]] const std::string& graphics() const;

 private:
  class Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace calot::gui
