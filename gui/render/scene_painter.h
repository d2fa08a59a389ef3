// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "gui/render/draw_list.h"
#include "gui/render/edge_smoother.h"
#include "gui/render/gl_objects.h"
#include "gui/render/renderer.h"
#include "gui/render/scene_resources.h"

namespace calot::gui {

/// Draws a DrawList: shadow of the endoscope's light, normals and depth, occlusion, lit surfaces, composition. Reuses
/// shaders and buffers between pictures. Call on the thread where the context is current.
class ScenePainter {
 public:
  explicit ScenePainter(const GraphicsContext& context);
  ~ScenePainter();

  /// The OpenGL implementation's own name of what draws: "llvmpipe (LLVM 15.0.6, 256 bits)".
  [[nodiscard]] std::string implementation() const;

  /// @param sight for which the list was built
  /// @pre checkPictureSize(width, height) and checkView() have passed
  [[nodiscard]] Image paint(const DrawList& list, const Sight& sight, double verticalFieldOfView, int width, int height,
                            const RenderSettings& settings);
  /// The same without reading it back, and edges of interactive quality are not smoothed: the framebuffer that is bound
  /// then holds the picture, its first row lowest.
  void draw(const DrawList& list, const Sight& sight, double verticalFieldOfView, int width, int height,
            const RenderSettings& settings);

 private:
  struct Frame;

  void prepareTargets(int width, int height, Quality quality);
  void clear(const RenderTarget& target, GLbitfield what, float alpha = 0.0F, float grey = 0.0F) const;
  /// Binds the target and confines drawing to the endoscope's field.
  void begin(const RenderTarget& target, const Frame& frame) const;
  void setCamera(const ShaderProgram& program, float focalX, float focalY, float x, float y) const;
  void setLighting(const ShaderProgram& program, const Frame& frame, const RenderTarget& target) const;

  void drawPart(const DrawPart& part) const;
  void drawParts(const DrawList& list, bool withSurroundings) const;
  void drawLit(const DrawPart& part, const Frame& frame, const RenderTarget& target) const;
  /// One triangle over all that begin() left to draw on.
  void drawPicture() const;
  void hideSurround(const Frame& frame) const;

  void drawOcclusion(const DrawList& list, const Frame& frame) const;
  void drawSurfaces(const DrawList& list, const Frame& frame) const;
  void drawBlended(const TriangleBuffer& triangles, std::size_t indices) const;
  void drawSheets(const SheetList& sheets, const Frame& frame);
  void drawSmoke(const SmokeList& smoke, const Frame& frame) const;
  /// Draws all that may come, nowhere.
  void makeReady(const DrawList& list, const Frame& frame);
  void compose(const Frame& frame) const;

  GlFunctions gl_;
  std::unique_ptr<ScenePrograms> film_, interactive_;
  bool ready_ = false;
  std::unique_ptr<PictureTargets> targets_;
  SceneTextures textures_;
  TriangleBuffer surfaces_, sheets_, smoke_;
  EdgeSmoother smoother_;
  GLuint emptyArray_ = 0;  ///< for triangles that shaders make
};

}  // namespace calot::gui
