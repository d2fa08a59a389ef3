// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gui/render/gl_functions.h"
#include "gui/render/smoke.h"

namespace calot::gui {

class SmokePainter {
 public:
  /// @pre the context of `gl` is current, here and in every call; `gl` outlives this
  explicit SmokePainter(const GlFunctions& gl);
  ~SmokePainter();
  SmokePainter(const SmokePainter&) = delete;
  SmokePainter& operator=(const SmokePainter&) = delete;

  /// @pre the smoke's program is in use with its uniforms set; the target is bound, with depth
  void draw(const SmokeList& list) const;

 private:
  const GlFunctions& gl_;
  GLuint vertexArray_ = 0, vertexBuffer_ = 0, indexBuffer_ = 0;
};

}  // namespace calot::gui
