// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <string>

#include "gui/render/draw_list.h"
#include "gui/render/gl_functions.h"
#include "gui/render/render_target.h"
#include "gui/render/renderer.h"
#include "gui/render/scene_programs.h"
#include "gui/render/sheet_painter.h"
#include "gui/render/smoke_painter.h"

namespace calot::gui {

/// Draws a DrawList: shadow of the endoscope's light, normals and depth, occlusion, lit surfaces, composition. Keeps
/// shaders and buffers from picture to picture. Everything happens on the thread where the context is current.
class ScenePainter {
 public:
  explicit ScenePainter(const GraphicsContext& context);
  ~ScenePainter();
  ScenePainter(const ScenePainter&) = delete;
  ScenePainter& operator=(const ScenePainter&) = delete;

  /// @pre checkPictureSize(width, height) and checkView() have passed
  [[nodiscard]] Image paint(const DrawList& list, double verticalFieldOfView, int width, int height,
                            const RenderSettings& settings);
  [[nodiscard]] std::string description() const;

 private:
  struct Targets;
  struct Frame;

  void upload(const DrawList& list);
  void prepareTargets(int width, int height, Quality quality);
  void clear(const RenderTarget& target, GLbitfield what, float alpha = 0.0F, float grey = 0.0F) const;
  /// Binds the target and confines drawing to the endoscope's field.
  void begin(const RenderTarget& target, const Frame& frame) const;
  void setCamera(const ShaderProgram& program, float focalX, float focalY, float x, float y) const;
  void setLighting(const ShaderProgram& program, const Frame& frame, const RenderTarget& target) const;

  void drawPart(const DrawPart& part) const;
  void drawParts(const DrawList& list, bool withCavity) const;
  void drawLit(const DrawPart& part, const Frame& frame, const RenderTarget& target) const;
  /// One triangle over all that begin() left to draw on.
  void drawPicture() const;
  void hideSurround(const Frame& frame) const;

  void drawOcclusion(const DrawList& list, const Frame& frame) const;
  void drawSurfaces(const DrawList& list, const Frame& frame) const;
  void drawSheets(const SheetList& sheets, const Frame& frame);
  void drawSmoke(const SmokeList& smoke, const Frame& frame);
  void compose(const Frame& frame) const;
  [[nodiscard]] Image read() const;

  GlFunctions gl_;
  std::unique_ptr<ScenePrograms> film_, interactive_;
  std::unique_ptr<Targets> targets_;
  std::unique_ptr<SheetPainter> sheets_;  ///< from the first picture with connective tissue on
  std::unique_ptr<SmokePainter> smoke_;   ///< from the first picture with smoke on
  GLuint vertexArray_ = 0, emptyArray_ = 0, vertexBuffer_ = 0, indexBuffer_ = 0;
  std::array<GLuint, 2> noise_{};  ///< in half floats, for film; in bytes, for interactive quality
};

}  // namespace calot::gui
