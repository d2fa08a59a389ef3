// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/scene_painter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "gui/render/noise_texture.h"
#include "recorder/errors.h"

namespace calot::gui {
namespace {

constexpr float nearPlane = 0.002F, farPlane = 2.0F;  // m
constexpr float lightX = 0.0045F, lightY = -0.0050F;  // of the light's bundle beside the lens, in C (m)
constexpr float shadowHalfWidth = 1.25F;              // of the light's field over the picture's
constexpr float occlusionReach = 0.016F;              // m

enum Unit : int {
  noiseUnit = 0,
  occlusionUnit = 1,
  shadowUnit = 2,
  depthUnit = 3,
  fibreUnit = 4,
  normalUnit = 5,
  backdropUnit = 6
};

int samplesAside(Quality quality) { return quality == Quality::film ? 2 : 1; }

}  // namespace

/// What the passes of one picture share.
struct ScenePainter::Frame {
  ScenePrograms& programs;
  float focalX = 1.0F, focalY = 1.0F, shadowFocal = 1.0F;
  float referenceDistance = 0.1F;    ///< DrawList::referenceDistance
  float rim = 0.0F, feather = 0.0F;  ///< radius of the round field, half the width of its soft edge (pixels); or 0
  float halfX = 0.0F, halfY = 0.0F;  ///< half axes of the polygon around it (clip coordinates)

  /// What lies around the field is black, and costs nothing.
  void setField(int width, int height) {
    const auto w = static_cast<float>(width), h = static_cast<float>(height);
    rim = 0.5F * std::min(w, h) * (width == height ? 0.985F : 1.12F);  // wide pictures cut it above and below
    feather = 1.5F;
    constexpr float beyond = 8.0F;  // pixels, so that passes of half the size have neighbours at the rim
    const float half = (rim + feather + beyond) / std::cos(std::numbers::pi_v<float> / fieldSides);
    halfX = 2.0F * half / w;
    halfY = 2.0F * half / h;
  }
};

struct ScenePainter::Targets {
  Targets(const GlFunctions& gl, int w, int h, Quality q)
      : width(w),
        height(h),
        quality(q),
        shadow(gl, shadowSide(q), shadowSide(q), {{}, true, false, q == Quality::interactive}),
        prepass(gl, coarse(w, q), coarse(h, q), {{GL_R32F, GL_RGBA8}, true}),
        open(gl, prepass.width() / occlusionStride(q), prepass.height() / occlusionStride(q), {{GL_R8}}),
        smoothed(gl, open.width(), open.height(), {{GL_R8}, false, true}),
        radiance(gl, w * samplesAside(q), h * samplesAside(q), {{radianceFormat(q)}, true}) {
    if (q == Quality::film)
      picture = std::make_unique<RenderTarget>(gl, w, h, RenderTarget::Layout{{GL_RGBA8}});
    else
      backdrop = std::make_unique<RenderTarget>(gl, prepass.width(), prepass.height(),
                                                RenderTarget::Layout{{GL_RGBA8}, false, true, false, &prepass});
  }
  static GLenum radianceFormat(Quality q) { return q == Quality::film ? GL_RGBA16F : GL_RGBA8; }
  static int coarse(int side, Quality q) { return q == Quality::film ? side : (side + 1) / 2; }
  static int shadowSide(Quality q) { return q == Quality::film ? 1536 : 768; }

  int width, height;
  Quality quality;
  RenderTarget shadow, prepass, open, smoothed;
  RenderTarget radiance;                   ///< film: linear light; interactive: the picture itself, upside down
  std::unique_ptr<RenderTarget> picture;   ///< film
  std::unique_ptr<RenderTarget> backdrop;  ///< interactive: the cavity alone, at half the size
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
  std::vector<std::uint8_t> bytes;
  bytes.reserve(volume.size());
  for (std::size_t i = 0; i < volume.size(); ++i) {  // slopes within [-2, 2], values within [-1, 1]
    const float share = volume[i] * (i % 4 == 3 ? 0.5F : 0.25F) + 0.5F;
    bytes.push_back(static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(share, 0.0F, 1.0F))));
  }
  gl_.GenTextures(2, noise_.data());
  gl_.ActiveTexture(GL_TEXTURE0 + noiseUnit);
  const auto makeNoise = [&](GLuint texture, GLint format, GLenum type, const void* texels, GLint filter) {
    gl_.BindTexture(GL_TEXTURE_3D, texture);
    gl_.TexImage3D(GL_TEXTURE_3D, 0, format, noiseSide, noiseSide, noiseSide, 0, GL_RGBA, type, texels);
    if (filter != GL_LINEAR) gl_.GenerateMipmap(GL_TEXTURE_3D);
    gl_.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, filter);
    gl_.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  };
  makeNoise(noise_[0], GL_RGBA16F, GL_FLOAT, volume.data(), GL_LINEAR_MIPMAP_LINEAR);
  makeNoise(noise_[1], GL_RGBA8, GL_UNSIGNED_BYTE, bytes.data(), GL_LINEAR);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(GL_LESS);
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
}

ScenePainter::~ScenePainter() {
  gl_.DeleteTextures(2, noise_.data());
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
  // Of a closed body only the near side is seen; of the cavity, from outside, only the far wall. Other surfaces may be
  // open: both sides are drawn.
  if (part.oneSided) gl_.Enable(GL_CULL_FACE);
  const std::size_t offset = part.firstIndex * sizeof(std::uint32_t);
  gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(part.indexCount), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(offset));
  if (part.oneSided) gl_.Disable(GL_CULL_FACE);
}

void ScenePainter::drawParts(const DrawList& list, bool withCavity) const {
  gl_.BindVertexArray(vertexArray_);
  for (const DrawPart& part : list.part)
    if (withCavity || part.appearance != Appearance::cavity) drawPart(part);
}

void ScenePainter::drawPicture() const {
  gl_.BindVertexArray(emptyArray_);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

void ScenePainter::hideSurround(const Frame& frame) const {
  if (frame.halfX == 0.0F) return;
  const ShaderProgram& program = frame.programs.surround;
  program.use();
  program.set("field", frame.halfX, frame.halfY);
  gl_.BindVertexArray(emptyArray_);
  gl_.DrawArrays(GL_TRIANGLES, 0, 6 * fieldSides);
}

void ScenePainter::prepareTargets(int width, int height, Quality quality) {
  std::unique_ptr<ScenePrograms>& programs = quality == Quality::film ? film_ : interactive_;
  if (!programs) programs = std::make_unique<ScenePrograms>(gl_, quality);
  if (targets_ && targets_->width == width && targets_->height == height && targets_->quality == quality) return;
  targets_.reset();  // before the new ones: both together may not fit
  targets_ = std::make_unique<Targets>(gl_, width, height, quality);
}

void ScenePainter::setCamera(const ShaderProgram& program, float focalX, float focalY, float x, float y) const {
  program.use();
  program.set("noiseVolume", static_cast<int>(noiseUnit));
  program.set("focal", focalX, focalY);
  program.set("depthRange", nearPlane, farPlane);
  program.set("eye", x, y, 0.0F);
}

void ScenePainter::clear(const RenderTarget& target, GLbitfield what, float alpha, float grey) const {
  gl_.Disable(GL_SCISSOR_TEST);
  target.bind();
  gl_.ClearColor(grey, grey, grey, alpha);
  gl_.Clear(what);
}

void ScenePainter::begin(const RenderTarget& target, const Frame& frame) const {
  target.bind();
  if (frame.halfX == 0.0F) return;
  const auto clip = [&](float half, int side) {  // first pixel, and how many
    const float middle = 0.5F * static_cast<float>(side);
    const int first = std::max(0, static_cast<int>(std::floor(middle * (1.0F - half))));
    return std::pair(first, side - 2 * first);
  };
  const auto [x, width] = clip(frame.halfX, target.width());
  const auto [y, height] = clip(frame.halfY, target.height());
  gl_.Enable(GL_SCISSOR_TEST);
  gl_.Scissor(x, y, width, height);
}

void ScenePainter::drawOcclusion(const DrawList& list, const Frame& frame) const {
  const Targets& targets = *targets_;
  const ScenePrograms& programs = frame.programs;
  clear(targets.prepass, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  begin(targets.prepass, frame);
  hideSurround(frame);
  setCamera(programs.prepass, frame.focalX, frame.focalY, 0.0F, 0.0F);
  drawParts(list, true);

  // What lies around the field is read by neighbours and filters: without this, memory that was there before.
  clear(targets.open, GL_COLOR_BUFFER_BIT, 1.0F, 1.0F);
  begin(targets.open, frame);
  setCamera(programs.occlusion, frame.focalX, frame.focalY, 0.0F, 0.0F);
  targets.prepass.sampleColour(depthUnit, 0);
  targets.prepass.sampleColour(normalUnit, 1);
  programs.occlusion.set("depthMap", static_cast<int>(depthUnit));
  programs.occlusion.set("normalMap", static_cast<int>(normalUnit));
  programs.occlusion.set("reach", occlusionReach);
  drawPicture();

  clear(targets.smoothed, GL_COLOR_BUFFER_BIT, 1.0F, 1.0F);
  begin(targets.smoothed, frame);
  programs.blur.use();
  targets.open.sampleColour(occlusionUnit);
  programs.blur.set("openMap", static_cast<int>(occlusionUnit));
  programs.blur.set("depthMap", static_cast<int>(depthUnit));
  programs.blur.set("normalMap", static_cast<int>(normalUnit));
  drawPicture();
  targets.smoothed.sampleColour(occlusionUnit);
}

void ScenePainter::setLighting(const ShaderProgram& program, const Frame& frame, const RenderTarget& target) const {
  setCamera(program, frame.focalX, frame.focalY, 0.0F, 0.0F);
  program.set("shadowMap", static_cast<int>(shadowUnit));
  program.set("shadowFocal", frame.shadowFocal, frame.shadowFocal);
  program.set("light", lightX, lightY, 0.0F);
  program.set("occlusionMap", static_cast<int>(occlusionUnit));
  program.set("referenceDistance", frame.referenceDistance);
  program.set("pixels", static_cast<float>(target.width()), static_cast<float>(target.height()));
  const float scale = static_cast<float>(target.width()) / static_cast<float>(targets_->width);
  program.set("fieldRim", scale * frame.rim, scale * frame.feather);
}

void ScenePainter::drawLit(const DrawPart& part, const Frame& frame, const RenderTarget& target) const {
  const ShaderProgram& program = frame.programs.surface(part);
  setLighting(program, frame, target);
  program.set("appearance", static_cast<int>(part.appearance));
  drawPart(part);
}

void ScenePainter::drawSurfaces(const DrawList& list, const Frame& frame) const {
  const Targets& targets = *targets_;
  gl_.BindVertexArray(vertexArray_);
  const auto isCavity = [](const DrawPart& part) { return part.appearance == Appearance::cavity; };
  const auto cavity = std::find_if(list.part.begin(), list.part.end(), isCavity);
  const bool apart = targets.backdrop && cavity != list.part.end();
  if (apart) {
    // Only where it is seen: with the depth of all that was drawn before.
    clear(*targets.backdrop, GL_COLOR_BUFFER_BIT);
    begin(*targets.backdrop, frame);
    gl_.DepthFunc(GL_LEQUAL);
    drawLit(*cavity, frame, *targets.backdrop);
    gl_.DepthFunc(GL_LESS);
  }
  clear(targets.radiance, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, 1.0F);  // outside of the field
  begin(targets.radiance, frame);
  gl_.ClearColor(0.0F, 0.0F, 0.0F, 0.0F);
  gl_.Clear(GL_COLOR_BUFFER_BIT);
  hideSurround(frame);
  gl_.BindVertexArray(vertexArray_);
  for (const DrawPart& part : list.part)
    if (!(apart && isCavity(part))) drawLit(part, frame, targets.radiance);
  if (!apart) return;
  const ShaderProgram& copy = frame.programs.backdrop;
  copy.use();
  targets.backdrop->sampleColour(backdropUnit);
  copy.set("backdropMap", static_cast<int>(backdropUnit));
  copy.set("pixels", static_cast<float>(targets.radiance.width()), static_cast<float>(targets.radiance.height()));
  gl_.DepthFunc(GL_LEQUAL);  // behind everything
  drawPicture();
  gl_.DepthFunc(GL_LESS);
}

void ScenePainter::drawSheets(const SheetList& sheets, const Frame& frame) {
  if (sheets.index.empty()) return;
  if (!sheets_) sheets_ = std::make_unique<SheetPainter>(gl_, fibreUnit);
  setLighting(frame.programs.sheet, frame, targets_->radiance);
  frame.programs.sheet.set("fibreMap", static_cast<int>(fibreUnit));
  sheets_->draw(sheets);
}

void ScenePainter::drawSmoke(const SmokeList& smoke, const Frame& frame) {
  if (smoke.index.empty()) return;
  if (!smoke_) smoke_ = std::make_unique<SmokePainter>(gl_);
  setLighting(frame.programs.smoke, frame, targets_->radiance);
  smoke_->draw(smoke);
}

void ScenePainter::compose(const Frame& frame) const {
  const Targets& targets = *targets_;
  clear(*targets.picture, GL_COLOR_BUFFER_BIT, frame.halfX > 0.0F ? 1.0F : 0.0F);
  begin(*targets.picture, frame);
  const ShaderProgram& program = frame.programs.compose;
  program.use();
  targets.radiance.sampleColour(depthUnit);
  program.set("radianceMap", static_cast<int>(depthUnit));
  program.set("fieldRim", frame.rim, frame.feather);
  drawPicture();
}

Image ScenePainter::read() const {
  const int width = targets_->width, height = targets_->height;
  Image image{width, height,
              std::vector<std::uint8_t>(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  gl_.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  if (gl_.GetError() != GL_NO_ERROR)
    throw Error(ExitCode::failure, "rendering: OpenGL reported an error; is memory short?");
  return image;
}

Image ScenePainter::paint(const DrawList& list, double verticalFieldOfView, int width, int height,
                          const RenderSettings& settings) {
  const bool film = settings.quality == Quality::film;
  prepareTargets(width, height, settings.quality);
  upload(list);
  gl_.ActiveTexture(GL_TEXTURE0 + noiseUnit);
  gl_.BindTexture(GL_TEXTURE_3D, noise_[film ? 0 : 1]);

  Frame frame{film ? *film_ : *interactive_};
  frame.focalY = static_cast<float>(1.0 / std::tan(0.5 * verticalFieldOfView));
  frame.focalX = frame.focalY * static_cast<float>(height) / static_cast<float>(width);
  frame.shadowFocal = std::min(frame.focalX, frame.focalY) / shadowHalfWidth;
  frame.referenceDistance = list.referenceDistance;
  if (settings.endoscopeMask) frame.setField(width, height);

  clear(targets_->shadow, GL_DEPTH_BUFFER_BIT);
  setCamera(frame.programs.shadow, frame.shadowFocal, frame.shadowFocal, lightX, lightY);
  drawParts(list, false);
  targets_->shadow.sampleDepth(shadowUnit);

  // Rows of an Image go from top to bottom, OpenGL's upwards: film turns them when it composes, interactive quality
  // draws upside down, which turns triangles too.
  if (!film) frame.focalY = -frame.focalY;
  gl_.FrontFace(film ? GL_CCW : GL_CW);
  drawOcclusion(list, frame);
  drawSurfaces(list, frame);
  drawSheets(list.sheets, frame);
  drawSmoke(list.smoke, frame);
  gl_.FrontFace(GL_CCW);
  if (film) compose(frame);
  return read();
}

}  // namespace calot::gui
