// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "gui/render/gl_functions.h"
#include "gui/render/renderer.h"

namespace calot::gui {

/// What each texture unit is for.
enum TextureUnit : int {
  noiseUnit = 0,
  occlusionUnit = 1,
  shadowUnit = 2,
  depthUnit = 3,
  fibreUnit = 4,
  normalUnit = 5,
  backdropUnit = 6,
  veinUnit = 7
};

/// The textures that do not change: the noise volume of both qualities, veins, and the fibres of connective tissue.
/// Veins stay bound to their unit.
class SceneTextures {
 public:
  /// @pre the context of `gl` is current, here and in every call; `gl` outlives this
  explicit SceneTextures(const GlFunctions& gl);
  ~SceneTextures();
  SceneTextures(const SceneTextures&) = delete;
  SceneTextures& operator=(const SceneTextures&) = delete;

  void bindNoise(Quality quality) const;
  /// Makes them at the first call.
  void bindFibres();

 private:
  /// A repeating texture with smaller copies for the distance, bound to the active unit.
  [[nodiscard]] GLuint makeFlat(GLint kept, GLenum format, int columns, int rows,
                                const std::vector<std::uint8_t>& texels) const;

  const GlFunctions& gl_;
  GLuint filmNoise_ = 0;         ///< half floats, with smaller copies for the distance
  GLuint interactiveNoise_ = 0;  ///< bytes
  GLuint fibres_ = 0;
  GLuint veins_ = 0;
};

}  // namespace calot::gui
