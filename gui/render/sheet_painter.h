// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gui/render/gl_functions.h"
#include "gui/render/sheet_list.h"

namespace calot::gui {

/// Blends a SheetList over what is drawn already. Keeps buffers and the fibre texture from picture to picture.
class SheetPainter {
 public:
  /// @pre the context of `gl` is current, here and in every call; `gl` outlives this
  /// @param fibreUnit a texture unit, which every draw() binds the fibre texture to
  SheetPainter(const GlFunctions& gl, int fibreUnit);
  ~SheetPainter();
  SheetPainter(const SheetPainter&) = delete;
  SheetPainter& operator=(const SheetPainter&) = delete;

  /// @pre the sheets' program is in use with its uniforms set, "fibreMap" to fibreUnit; the target is bound, with
  /// depth
  void draw(const SheetList& list) const;

 private:
  const GlFunctions& gl_;
  GLenum fibreUnit_;
  GLuint vertexArray_ = 0, vertexBuffer_ = 0, indexBuffer_ = 0, fibres_ = 0;
};

}  // namespace calot::gui
