// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "gui/render/draw_list.h"
#include "gui/render/gl_functions.h"
#include "gui/render/render_target.h"
#include "gui/render/renderer.h"
#include "gui/render/shader_program.h"
#include "gui/render/sheet_painter.h"

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
  struct Programs;
  struct Targets;

  void upload(const DrawList& list);
  void drawPart(const DrawPart& part) const;
  void drawParts(const DrawList& list, bool withCavity) const;
  void drawPicture();
  void drawSheets(const SheetList& sheets);
  void prepareTargets(int width, int height, Quality quality);

  GlFunctions gl_;
  std::unique_ptr<Programs> film_, interactive_;
  std::unique_ptr<Targets> targets_;
  std::unique_ptr<SheetPainter> sheets_;  ///< from the first picture with connective tissue on
  GLuint vertexArray_ = 0, emptyArray_ = 0, vertexBuffer_ = 0, indexBuffer_ = 0, noise_ = 0;
};

}  // namespace calot::gui
