// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "gui/render/draw_list.h"
#include "gui/render/gl_objects.h"
#include "gui/render/renderer.h"

namespace calot::gui {

/// Looks that a painter has drawn. For the first picture of one a software OpenGL compiles programs, for up to a
/// second.
using LooksDrawn = std::set<std::pair<Quality, int>>;
/// Notes the looks of a picture. @return is one of them new?
bool noteLooks(LooksDrawn& drawn, const DrawList& list, const RenderSettings& settings);

/// Parts in every look that an attempt which begins like this may come to: tissue that is charred or parted, clips,
/// blood, every instrument. Each is one triangle of the list. @pre the list has a part
[[nodiscard]] std::vector<DrawPart> looksToCome(const DrawList& list);

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

 private:
  const GlFunctions& gl_;
  const char* choices_;  ///< of the quality
  std::map<std::pair<int, bool>, std::unique_ptr<ShaderProgram>> surface_;

 public:
  const ShaderProgram shadow, prepass, surround, sheet, smoke, occlusion, backdrop, blur, compose;
};

/// Use of each texture unit.
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

/// Render targets of a picture of one size and quality.
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

/// Side of the noise volume (texels) and cells along it: 8 texels a cell, so that linear filtering stays smooth.
inline constexpr int noiseSide = 64;
inline constexpr int noiseCells = 8;

/// A periodic volume of gradient noise for procedural colours and bumps: for each texel (x fastest) the derivatives of
/// the noise by the three coordinates in cells, then its value, all within about [-2, 2] and [-1, 1]. Quintic fade
/// (Perlin, "Improving noise", SIGGRAPH 2002), gradients by an integer hash, so the volume is the same everywhere.
/// @return 4 noiseSide^3 values
[[nodiscard]] std::vector<float> makeNoiseVolume();

/// Sides of the fibre texture (texels): across the fibres and along them. It repeats in both directions.
inline constexpr int fibreColumns = 512;
inline constexpr int fibreRows = 256;

/// A picture of areolar tissue: fibres along t that branch and join, in a gossamer film with gaps, from the noise
/// volume. Four bytes a texel, s fastest: cover by fibres (0 to 255), thickness of the film, height's slope across the
/// fibres (128: level), tone.
/// @return 4 fibreColumns fibreRows values
[[nodiscard]] std::vector<std::uint8_t> makeFibreTexture();

/// Side of the texture of veins (texels). It repeats in both directions.
inline constexpr int veinSide = 512;

/// Veins as they branch under serosa: trunks that wander along t, divide into ever thinner ones by Murray's law (the
/// cubes of the radii add up), and fade as they thin out. One byte a texel, s fastest: cover, 0 to 255.
/// @return veinSide^2 values, the same everywhere
[[nodiscard]] std::vector<std::uint8_t> makeVeinTexture();

}  // namespace calot::gui
