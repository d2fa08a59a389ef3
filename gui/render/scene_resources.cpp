// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/scene_resources.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "gui/render/procedural_textures.h"
#include "gui/render/shader_sources.h"

namespace calot::gui {

namespace {

constexpr int sheetLook = -1, smokeLook = -2, readyLook = -3;

int lookOf(const DrawPart& part) { return 2 * static_cast<int>(part.appearance) + (part.harmed ? 1 : 0); }

bool isTissue(Appearance a) { return a < Appearance::insulation && !isSurroundings(a); }

}  // namespace

bool noteLooks(LooksDrawn& drawn, const DrawList& list, const RenderSettings& settings) {
  bool isNew = false;
  const auto add = [&](int look) { isNew = drawn.insert({settings.quality, look}).second || isNew; };
  for (const DrawPart& part : list.part) add(lookOf(part));
  if (!list.sheets.index.empty()) add(sheetLook);
  if (!list.smoke.index.empty()) add(smokeLook);
  if (settings.ready) add(readyLook);
  return isNew;
}

std::vector<DrawPart> looksToCome(const DrawList& list) {
  std::vector<DrawPart> parts;
  const auto add = [&](Appearance appearance, bool harmed) {
    DrawPart part = list.part.front();
    part.indexCount = 3;
    part.appearance = appearance;
    part.harmed = harmed;
    const auto same = [&](const DrawPart& other) { return lookOf(other) == lookOf(part); };
    if (std::none_of(parts.begin(), parts.end(), same) && std::none_of(list.part.begin(), list.part.end(), same))
      parts.push_back(part);
  };
  bool vessels = false;
  for (const DrawPart& part : list.part) {
    if (isTissue(part.appearance)) add(part.appearance, true);
    vessels = vessels || part.appearance == Appearance::duct || part.appearance == Appearance::artery;
  }
  for (const Appearance a : {Appearance::insulation, Appearance::steel, Appearance::ceramic}) add(a, false);
  if (vessels)
    for (const Appearance a :
         {Appearance::titanium, Appearance::blood, Appearance::bile, Appearance::omentum, Appearance::bowel})
      add(a, false);
  return parts;
}

ScenePrograms::ScenePrograms(const GlFunctions& gl, Quality quality)
    : gl_(gl),
      choices_(quality == Quality::film ? glsl::filmChoices : glsl::interactiveChoices),
      shadow(gl, "shadow", {choices_, glsl::common, glsl::surfaceVertex}, {glsl::emptyFragment}),
      prepass(gl, "prepass", {choices_, glsl::common, glsl::surfaceVertex}, {glsl::prepassFragment}),
      surround(gl, "surround", {choices_, glsl::common, glsl::surroundVertex}, {glsl::surroundFragment}),
      sheet(gl, "sheet", {choices_, glsl::common, glsl::sheetVertex},
            {choices_, glsl::common, glsl::display, glsl::receiver, glsl::shadowLookup, glsl::sheetFragment}),
      smoke(gl, "smoke", {choices_, glsl::common, glsl::smokeVertex},
            {choices_, glsl::common, glsl::display, glsl::receiver, glsl::smokeFragment}),
      occlusion(gl, "occlusion", {glsl::pictureVertex}, {choices_, glsl::common, glsl::occlusionFragment}),
      backdrop(gl, "backdrop", {glsl::pictureVertex}, {glsl::backdropFragment}),
      blur(gl, "blur", {glsl::pictureVertex}, {choices_, glsl::blurFragment}),
      compose(gl, "compose", {glsl::pictureVertex}, {choices_, glsl::display, glsl::composeFragment}) {}

const ShaderProgram& ScenePrograms::surface(const DrawPart& part) {
  const int look = static_cast<int>(part.appearance);
  std::unique_ptr<ShaderProgram>& program = surface_[{look, part.harmed}];
  if (!program) {
    const std::string choice = fmt::format("#define LOOK {}\n#define HARMED {}\n", look, part.harmed ? 1 : 0);
    program = std::make_unique<ShaderProgram>(
        gl_, "surface",
        std::initializer_list<const char*>{choice.c_str(), choices_, glsl::common, glsl::surfaceBroad,
                                           glsl::surfaceVertex},
        std::initializer_list<const char*>{choice.c_str(), choices_, glsl::common, glsl::surfaceBroad,
                                           glsl::surfaceMaterial, glsl::display, glsl::receiver, glsl::shadowLookup,
                                           glsl::softShadow, glsl::surfaceFragment});
  }
  return *program;
}

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

namespace {

GLenum radianceFormat(Quality q) { return q == Quality::film ? GL_RGBA16F : GL_RGBA8; }
int samplesAside(Quality q) { return q == Quality::film ? 2 : 1; }
int coarse(int side, Quality q) { return q == Quality::film ? side : (side + 1) / 2; }
int shadowSide(Quality q) { return q == Quality::film ? 1536 : 512; }

}  // namespace

PictureTargets::PictureTargets(const GlFunctions& gl, int w, int h, Quality q)
    : width(w),
      height(h),
      quality(q),
      shadow(gl, shadowSide(q), shadowSide(q), {{}, true, false, q == Quality::interactive}),
      prepass(gl, coarse(w, q), coarse(h, q), {{GL_R32F, GL_RGBA8}, true}),
      open(gl, prepass.width() / occlusionStride(q), prepass.height() / occlusionStride(q), {{GL_RGBA8}}),
      smoothed(gl, open.width(), open.height(), {{GL_R8}, false, true}),
      radiance(gl, w * samplesAside(q), h * samplesAside(q), {{radianceFormat(q)}, true}) {
  if (q == Quality::film)
    picture = std::make_unique<RenderTarget>(gl, w, h, RenderTarget::Layout{{GL_RGBA8}});
  else
    backdrop = std::make_unique<RenderTarget>(gl, prepass.width(), prepass.height(),
                                              RenderTarget::Layout{{GL_RGBA8}, false, true, false, &prepass});
}

}  // namespace calot::gui
