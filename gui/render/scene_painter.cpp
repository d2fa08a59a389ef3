// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/scene_painter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "gui/render/noise_texture.h"
#include "gui/render/shader_sources.h"
#include "recorder/errors.h"

namespace calot::gui {
namespace {

constexpr float nearPlane = 0.002F, farPlane = 2.0F;  // m
constexpr float lightX = 0.0045F, lightY = -0.0050F;  // of the light's bundle beside the lens, in C (m)
constexpr float shadowHalfWidth = 1.25F;              // of the light's field over the picture's
constexpr float occlusionReach = 0.016F;              // m

enum Unit : int { noiseUnit = 0, occlusionUnit = 1, shadowUnit = 2, depthUnit = 3, fibreUnit = 4 };

const char* const filmCounts =
    "#define OCCLUSION_SAMPLES 24\n#define BLOCKERS 8\n#define SHADOW_SAMPLES 16\n#define SHEET_SHADOW_SAMPLES 4\n";
const char* const interactiveCounts =
    "#define OCCLUSION_SAMPLES 8\n#define BLOCKERS 3\n#define SHADOW_SAMPLES 4\n#define SHEET_SHADOW_SAMPLES 1\n";

int samplesAside(Quality quality) { return quality == Quality::film ? 2 : 1; }

}  // namespace

struct ScenePainter::Programs {
  Programs(const GlFunctions& gl, const char* counts)
      : shadow(gl, "shadow", {glsl::common, glsl::surfaceVertex}, {glsl::shadowFragment}),
        prepass(gl, "prepass", {glsl::common, glsl::surfaceVertex}, {glsl::prepassFragment}),
        sheet(gl, "sheet", {glsl::common, glsl::sheetVertex}, {counts, glsl::common, glsl::sheetFragment}),
        occlusion(gl, "occlusion", {glsl::pictureVertex}, {counts, glsl::common, glsl::occlusionFragment}),
        blur(gl, "blur", {glsl::pictureVertex}, {glsl::blurFragment}),
        compose(gl, "compose", {glsl::pictureVertex}, {glsl::composeFragment}),
        gl_(gl),
        counts_(counts) {}

  /// The lit surface in one look; made when it is first drawn.
  const ShaderProgram& surface(const DrawPart& part) {
    const int look = std::min(static_cast<int>(part.appearance), static_cast<int>(Appearance::insulation));
    std::unique_ptr<ShaderProgram>& program = surface_[{look, part.harmed}];
    if (!program) {
      const std::string choice = fmt::format("#define LOOK {}\n#define HARMED {}\n", look, part.harmed ? 1 : 0);
      program = std::make_unique<ShaderProgram>(
          gl_, "surface", std::initializer_list<const char*>{glsl::common, glsl::surfaceVertex},
          std::initializer_list<const char*>{choice.c_str(), counts_, glsl::common, glsl::surfaceMaterial,
                                             glsl::surfaceFragment});
    }
    return *program;
  }

  ShaderProgram shadow, prepass, sheet, occlusion, blur, compose;

 private:
  const GlFunctions& gl_;
  const char* counts_;
  std::map<std::pair<int, bool>, std::unique_ptr<ShaderProgram>> surface_;
};

struct ScenePainter::Targets {
  Targets(const GlFunctions& gl, int w, int h, Quality q)
      : width(w),
        height(h),
        quality(q),
        shadow(gl, q == Quality::film ? 1536 : 768, q == Quality::film ? 1536 : 768, {{}, true, false}),
        prepass(gl, coarse(w, q), coarse(h, q), {{GL_RGBA32F}, true, false}),
        open(gl, prepass.width(), prepass.height(), {{GL_R8}, false, false}),
        smoothed(gl, prepass.width(), prepass.height(), {{GL_R8}, false, true}),
        radiance(gl, w * samplesAside(q), h * samplesAside(q), {{GL_RGBA16F}, true, false}),
        picture(gl, w, h, {{GL_RGBA8}, false, false}) {}
  static int coarse(int side, Quality q) { return q == Quality::film ? side : (side + 1) / 2; }

  int width, height;
  Quality quality;
  RenderTarget shadow, prepass, open, smoothed, radiance, picture;
};

ScenePainter::ScenePainter(const GraphicsContext& context) : gl_(context) {
  gl_.GenVertexArrays(1, &vertexArray_);
  gl_.GenVertexArrays(1, &emptyArray_);
  gl_.GenBuffers(1, &vertexBuffer_);
  gl_.GenBuffers(1, &indexBuffer_);
  gl_.BindVertexArray(vertexArray_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indexBuffer_);
  for (GLuint attribute = 0; attribute < 4; ++attribute) {
    gl_.EnableVertexAttribArray(attribute);
    const std::size_t offset = attribute * 3 * sizeof(float);
    gl_.VertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE, sizeof(DrawVertex),
                            reinterpret_cast<const void*>(offset));
  }
  gl_.EnableVertexAttribArray(4);
  gl_.VertexAttribPointer(4, 2, GL_FLOAT, GL_FALSE, sizeof(DrawVertex),
                          reinterpret_cast<const void*>(offsetof(DrawVertex, charred)));
  const std::vector<float> volume = makeNoiseVolume();
  gl_.GenTextures(1, &noise_);
  gl_.ActiveTexture(GL_TEXTURE0 + noiseUnit);
  gl_.BindTexture(GL_TEXTURE_3D, noise_);
  gl_.TexImage3D(GL_TEXTURE_3D, 0, GL_RGBA16F, noiseSide, noiseSide, noiseSide, 0, GL_RGBA, GL_FLOAT, volume.data());
  gl_.GenerateMipmap(GL_TEXTURE_3D);
  gl_.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  gl_.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(GL_LESS);
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
}

ScenePainter::~ScenePainter() {
  gl_.DeleteTextures(1, &noise_);
  gl_.DeleteBuffers(1, &vertexBuffer_);
  gl_.DeleteBuffers(1, &indexBuffer_);
  gl_.DeleteVertexArrays(1, &vertexArray_);
  gl_.DeleteVertexArrays(1, &emptyArray_);
}

std::string ScenePainter::description() const {
  const auto text = [&](GLenum name) {
    const GLubyte* const found = gl_.GetString(name);
    return found == nullptr ? std::string("unknown") : std::string(reinterpret_cast<const char*>(found));
  };
  return text(GL_RENDERER) + ", " + text(GL_VERSION);
}

void ScenePainter::upload(const DrawList& list) {
  gl_.BindVertexArray(vertexArray_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(list.vertex.size() * sizeof(DrawVertex)), list.vertex.data(),
                 GL_STREAM_DRAW);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(list.index.size() * sizeof(std::uint32_t)),
                 list.index.data(), GL_STREAM_DRAW);
}

void ScenePainter::drawPart(const DrawPart& part) const {
  // From outside, one looks through the near wall of the cavity. Other surfaces may be open: both sides are drawn.
  if (part.appearance == Appearance::cavity) gl_.Enable(GL_CULL_FACE);
  const std::size_t offset = part.firstIndex * sizeof(std::uint32_t);
  gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(part.indexCount), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(offset));
  gl_.Disable(GL_CULL_FACE);
}

void ScenePainter::drawParts(const DrawList& list, bool withCavity) const {
  gl_.BindVertexArray(vertexArray_);
  for (const DrawPart& part : list.part)
    if (part.indexCount > 0 && (withCavity || part.appearance != Appearance::cavity)) drawPart(part);
}

void ScenePainter::drawSheets(const SheetList& sheets) {
  if (!sheets_) sheets_ = std::make_unique<SheetPainter>(gl_, fibreUnit);
  sheets_->draw(sheets);
}

void ScenePainter::drawPicture() {
  gl_.BindVertexArray(emptyArray_);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.Enable(GL_DEPTH_TEST);
}

void ScenePainter::prepareTargets(int width, int height, Quality quality) {
  std::unique_ptr<Programs>& programs = quality == Quality::film ? film_ : interactive_;
  if (!programs) programs = std::make_unique<Programs>(gl_, quality == Quality::film ? filmCounts : interactiveCounts);
  if (targets_ && targets_->width == width && targets_->height == height && targets_->quality == quality) return;
  targets_.reset();  // before the new ones: both together may not fit
  targets_ = std::make_unique<Targets>(gl_, width, height, quality);
}

Image ScenePainter::paint(const DrawList& list, double verticalFieldOfView, int width, int height,
                          const RenderSettings& settings) {
  prepareTargets(width, height, settings.quality);
  Programs& programs = settings.quality == Quality::film ? *film_ : *interactive_;
  const Targets& targets = *targets_;
  upload(list);

  const float focalY = static_cast<float>(1.0 / std::tan(0.5 * verticalFieldOfView));
  const float focalX = focalY * static_cast<float>(height) / static_cast<float>(width);
  const float shadowFocal = std::min(focalX, focalY) / shadowHalfWidth;
  const auto clear = [&](const RenderTarget& target, GLbitfield what) {
    target.bind();
    gl_.ClearColor(0.0F, 0.0F, 0.0F, 0.0F);
    gl_.Clear(what);
  };
  const auto setCamera = [&](const ShaderProgram& program, float fx, float fy, float x, float y) {
    program.use();
    program.set("noiseVolume", static_cast<int>(noiseUnit));
    program.set("focal", fx, fy);
    program.set("depthRange", nearPlane, farPlane);
    program.set("eye", x, y, 0.0F);
  };

  clear(targets.shadow, GL_DEPTH_BUFFER_BIT);
  setCamera(programs.shadow, shadowFocal, shadowFocal, lightX, lightY);
  drawParts(list, false);

  clear(targets.prepass, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  setCamera(programs.prepass, focalX, focalY, 0.0F, 0.0F);
  drawParts(list, true);

  targets.open.bind();
  setCamera(programs.occlusion, focalX, focalY, 0.0F, 0.0F);
  targets.prepass.sampleColour(depthUnit);
  programs.occlusion.set("normalAndDepth", static_cast<int>(depthUnit));
  programs.occlusion.set("reach", occlusionReach);
  drawPicture();

  targets.smoothed.bind();
  programs.blur.use();
  targets.open.sampleColour(occlusionUnit);
  programs.blur.set("openMap", static_cast<int>(occlusionUnit));
  programs.blur.set("normalAndDepth", static_cast<int>(depthUnit));
  drawPicture();

  clear(targets.radiance, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  targets.smoothed.sampleColour(occlusionUnit);
  targets.shadow.sampleDepth(shadowUnit);
  const auto setLighting = [&](const ShaderProgram& program) {
    setCamera(program, focalX, focalY, 0.0F, 0.0F);
    program.set("occlusionMap", static_cast<int>(occlusionUnit));
    program.set("shadowMap", static_cast<int>(shadowUnit));
    program.set("shadowFocal", shadowFocal, shadowFocal);
    program.set("light", lightX, lightY, 0.0F);
    program.set("referenceDistance", list.referenceDistance);
    program.set("pixels", static_cast<float>(targets.radiance.width()), static_cast<float>(targets.radiance.height()));
  };
  for (const DrawPart& part : list.part) {
    if (part.indexCount == 0) continue;
    const ShaderProgram& program = programs.surface(part);
    setLighting(program);
    program.set("appearance", static_cast<int>(part.appearance));
    gl_.BindVertexArray(vertexArray_);
    drawPart(part);
  }
  if (!list.sheets.index.empty()) {
    setLighting(programs.sheet);
    programs.sheet.set("fibreMap", static_cast<int>(fibreUnit));
    drawSheets(list.sheets);
  }

  targets.picture.bind();
  programs.compose.use();
  targets.radiance.sampleColour(depthUnit);
  programs.compose.set("radianceMap", static_cast<int>(depthUnit));
  programs.compose.set("samples", samplesAside(settings.quality));
  programs.compose.set("mask", settings.endoscopeMask ? 1 : 0);
  drawPicture();

  Image image{width, height,
              std::vector<std::uint8_t>(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  gl_.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  if (gl_.GetError() != GL_NO_ERROR)
    throw Error(ExitCode::failure, "rendering: OpenGL reported an error; is memory short?");
  return image;
}

}  // namespace calot::gui
