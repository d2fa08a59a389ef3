// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <utility>

#include "gui/render/draw_list.h"
#include "gui/render/renderer.h"
#include "gui/render/shader_program.h"

namespace calot::gui {

/// Pixel spacing at which occlusion is computed in the prepass.
inline constexpr int occlusionStride(Quality quality) { return quality == Quality::film ? 1 : 2; }

/// All programs of one quality. Those that do not depend on a look are compiled here, the others when
/// they are first drawn.
class ScenePrograms {
 public:
  /// @pre the context of `gl` is current, here and in every call; `gl` outlives this
  ScenePrograms(const GlFunctions& gl, Quality quality);

  /// The lit surface in one look.
  [[nodiscard]] const ShaderProgram& surface(const DrawPart& part);

  const ShaderProgram shadow, prepass, surround, sheet, smoke, occlusion, backdrop, blur, compose;

 private:
  const GlFunctions& gl_;
  const char* choices_;
  std::map<std::pair<int, bool>, std::unique_ptr<ShaderProgram>> surface_;

  ScenePrograms(const GlFunctions& gl, const char* choices);
};

}  // namespace calot::gui
