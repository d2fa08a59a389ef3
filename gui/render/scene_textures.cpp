// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/scene_textures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "gui/render/fibre_texture.h"
#include "gui/render/noise_texture.h"
#include "gui/render/vein_texture.h"

namespace calot::gui {
namespace {

std::vector<std::uint8_t> asBytes(const std::vector<float>& volume) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(volume.size());
  for (std::size_t i = 0; i < volume.size(); ++i) {  // slopes within [-2, 2], values within [-1, 1]
    const float share = volume[i] * (i % 4 == 3 ? 0.5F : 0.25F) + 0.5F;
    bytes.push_back(static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(share, 0.0F, 1.0F))));
  }
  return bytes;
}

}  // namespace

SceneTextures::SceneTextures(const GlFunctions& gl) : gl_(gl) {
  const std::vector<float> volume = makeNoiseVolume();
  gl_.ActiveTexture(GL_TEXTURE0 + noiseUnit);
  const auto make = [&](GLuint& texture, GLint format, GLenum type, const void* texels, GLint filter) {
    gl_.GenTextures(1, &texture);
    gl_.BindTexture(GL_TEXTURE_3D, texture);
    gl_.TexImage3D(GL_TEXTURE_3D, 0, format, noiseSide, noiseSide, noiseSide, 0, GL_RGBA, type, texels);
    if (filter != GL_LINEAR) gl_.GenerateMipmap(GL_TEXTURE_3D);
    gl_.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, filter);
    gl_.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  };
  make(filmNoise_, GL_RGBA16F, GL_FLOAT, volume.data(), GL_LINEAR_MIPMAP_LINEAR);
  gl_.ActiveTexture(GL_TEXTURE0 + veinUnit);
  veins_ = makeFlat(GL_R8, GL_RED, veinSide, veinSide, makeVeinTexture());
  gl_.ActiveTexture(GL_TEXTURE0 + noiseUnit);
  make(interactiveNoise_, GL_RGBA8, GL_UNSIGNED_BYTE, asBytes(volume).data(), GL_LINEAR);
}

SceneTextures::~SceneTextures() {
  for (const GLuint texture : {filmNoise_, interactiveNoise_, fibres_, veins_}) gl_.DeleteTextures(1, &texture);
}

void SceneTextures::bindNoise(Quality quality) const {
  gl_.ActiveTexture(GL_TEXTURE0 + noiseUnit);
  gl_.BindTexture(GL_TEXTURE_3D, quality == Quality::film ? filmNoise_ : interactiveNoise_);
}

void SceneTextures::bindFibres() {
  gl_.ActiveTexture(GL_TEXTURE0 + fibreUnit);
  if (fibres_ != 0) {
    gl_.BindTexture(GL_TEXTURE_2D, fibres_);
    return;
  }
  fibres_ = makeFlat(GL_RGBA8, GL_RGBA, fibreColumns, fibreRows, makeFibreTexture());
}

GLuint SceneTextures::makeFlat(GLint kept, GLenum format, int columns, int rows,
                               const std::vector<std::uint8_t>& texels) const {
  GLuint texture = 0;
  gl_.GenTextures(1, &texture);
  gl_.BindTexture(GL_TEXTURE_2D, texture);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, kept, columns, rows, 0, format, GL_UNSIGNED_BYTE, texels.data());
  gl_.GenerateMipmap(GL_TEXTURE_2D);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return texture;
}

}  // namespace calot::gui
