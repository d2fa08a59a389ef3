// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/scene_painter.h"

#include <algorithm>
#include <cmath>

#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

constexpr float nearPlane = 0.002F, farPlane = 2.0F;  // m
constexpr float occlusionReach = 0.016F;              // m

/// @param scale of the target's pixels over the picture's
void setField(const ShaderProgram& program, const Sight& sight, float scale) {
  const float rim = scale * sight.rim, feather = scale * sight.feather;
  program.set("fieldRim", rim, feather);
  if (rim > 0.0F) program.set("fieldShare", 1.0F / rim, 0.5F / feather);
}

}  // namespace

/// Data shared by the passes of one picture.
struct ScenePainter::Frame {
  ScenePrograms& programs;
  const Sight& sight;
  float focalX = 1.0F, focalY = 1.0F, shadowFocal = 1.0F;
  float referenceDistance = 0.1F;  ///< DrawList::referenceDistance
};

ScenePainter::ScenePainter(const GraphicsContext& context)
    : gl_(context),
      textures_(gl_),
      surfaces_(gl_, sizeof(DrawVertex),
                {{3, offsetof(DrawVertex, position)},
                 {3, offsetof(DrawVertex, normal)},
                 {3, offsetof(DrawVertex, rest)},
                 {3, offsetof(DrawVertex, restNormal)},
                 {2, offsetof(DrawVertex, charred)}}),  // and the face behind it
      sheets_(gl_, sizeof(SheetVertex),
              {{3, offsetof(SheetVertex, position)},
               {3, offsetof(SheetVertex, normal)},
               {3, offsetof(SheetVertex, along)},
               {4, offsetof(SheetVertex, look)},
               {1, offsetof(SheetVertex, erosion)}}),
      smoke_(gl_, sizeof(SmokeVertex),
             {{3, offsetof(SmokeVertex, position)},
              {2, offsetof(SmokeVertex, corner)},
              {2, offsetof(SmokeVertex, opacity)}}) {  // and the offset behind it
  gl_.GenVertexArrays(1, &emptyArray_);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(GL_LESS);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);  // colours come multiplied by their opacity
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
}

ScenePainter::~ScenePainter() { gl_.DeleteVertexArrays(1, &emptyArray_); }

std::string ScenePainter::implementation() const {
  const GLubyte* name = gl_.GetString(GL_RENDERER);
  return name == nullptr ? "an unnamed OpenGL" : reinterpret_cast<const char*>(name);
}

void ScenePainter::drawPart(const DrawPart& part) const {
  // A closed body shows only its near side; the cavity, from outside, only its far wall. Other surfaces may be
  // open: both sides are drawn.
  if (part.oneSided) gl_.Enable(GL_CULL_FACE);
  surfaces_.draw(part.firstIndex, part.indexCount);
  if (part.oneSided) gl_.Disable(GL_CULL_FACE);
}

void ScenePainter::drawParts(const DrawList& list, bool withSurroundings) const {
  for (const DrawPart& part : list.part)
    if (withSurroundings || !isSurroundings(part.appearance)) drawPart(part);
}

void ScenePainter::drawPicture() const {
  gl_.BindVertexArray(emptyArray_);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

void ScenePainter::hideSurround(const Frame& frame) const {
  if (frame.sight.halfX == 0.0F) return;
  const ShaderProgram& program = frame.programs.surround;
  program.use();
  program.set("field", frame.sight.halfX, frame.sight.halfY);
  gl_.BindVertexArray(emptyArray_);
  gl_.DrawArrays(GL_TRIANGLES, 0, 6 * fieldSides);
}

void ScenePainter::prepareTargets(int width, int height, Quality quality) {
  std::unique_ptr<ScenePrograms>& programs = quality == Quality::film ? film_ : interactive_;
  if (!programs) programs = std::make_unique<ScenePrograms>(gl_, quality);
  if (targets_ && targets_->width == width && targets_->height == height && targets_->quality == quality) return;
  targets_.reset();  // before the new ones: both together may not fit
  targets_ = std::make_unique<PictureTargets>(gl_, width, height, quality);
}

void ScenePainter::setCamera(const ShaderProgram& program, float focalX, float focalY, float x, float y) const {
  program.use();
  program.set("noiseVolume", static_cast<int>(noiseUnit));
  program.set("veinMap", static_cast<int>(veinUnit));
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
  if (frame.sight.halfX == 0.0F) return;
  const auto clip = [&](float half, int side) {  // first pixel, and how many
    const float middle = 0.5F * static_cast<float>(side);
    const int first = std::max(0, static_cast<int>(std::floor(middle * (1.0F - half))));
    return std::pair(first, side - 2 * first);
  };
  const auto [x, width] = clip(frame.sight.halfX, target.width());
  const auto [y, height] = clip(frame.sight.halfY, target.height());
  gl_.Enable(GL_SCISSOR_TEST);
  gl_.Scissor(x, y, width, height);
}

void ScenePainter::drawOcclusion(const DrawList& list, const Frame& frame) const {
  const PictureTargets& targets = *targets_;
  const ScenePrograms& programs = frame.programs;
  clear(targets.prepass, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  begin(targets.prepass, frame);
  hideSurround(frame);
  setCamera(programs.prepass, frame.focalX, frame.focalY, 0.0F, 0.0F);
  drawParts(list, true);

  // Neighbours and filters read pixels around the field, which would otherwise hold stale memory.
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
  const auto width = static_cast<float>(target.width()), height = static_cast<float>(target.height());
  program.set("pixels", width, height);
  program.set("pixelShare", 1.0F / width, 1.0F / height);
  setField(program, frame.sight, width / static_cast<float>(targets_->width));
}

void ScenePainter::drawLit(const DrawPart& part, const Frame& frame, const RenderTarget& target) const {
  const ShaderProgram& program = frame.programs.surface(part);
  setLighting(program, frame, target);
  drawPart(part);
}

void ScenePainter::drawSurfaces(const DrawList& list, const Frame& frame) const {
  const PictureTargets& targets = *targets_;
  const auto isBehind = [](const DrawPart& part) { return isSurroundings(part.appearance); };
  const bool apart = targets.backdrop && std::any_of(list.part.begin(), list.part.end(), isBehind);
  if (apart) {
    // Only where it is seen: with the depth of all that was drawn before.
    clear(*targets.backdrop, GL_COLOR_BUFFER_BIT);
    begin(*targets.backdrop, frame);
    gl_.DepthFunc(GL_LEQUAL);
    for (const DrawPart& part : list.part)
      if (isBehind(part)) drawLit(part, frame, *targets.backdrop);
    gl_.DepthFunc(GL_LESS);
  }
  clear(targets.radiance, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, 1.0F);  // outside of the field
  begin(targets.radiance, frame);
  if (!apart) {
    gl_.ClearColor(0.0F, 0.0F, 0.0F, 0.0F);
    gl_.Clear(GL_COLOR_BUFFER_BIT);
  }
  hideSurround(frame);
  for (const DrawPart& part : list.part)
    if (!(apart && isBehind(part))) drawLit(part, frame, targets.radiance);
  if (!apart) return;
  const ShaderProgram& copy = frame.programs.backdrop;
  copy.use();
  targets.backdrop->sampleColour(backdropUnit);
  copy.set("backdropMap", static_cast<int>(backdropUnit));
  copy.set("pixelShare", 1.0F / static_cast<float>(targets.radiance.width()),
           1.0F / static_cast<float>(targets.radiance.height()));
  gl_.DepthFunc(GL_LEQUAL);  // behind everything
  drawPicture();
  gl_.DepthFunc(GL_LESS);
}

void ScenePainter::drawBlended(const TriangleBuffer& triangles, std::size_t indices) const {
  // Lists are sorted back to front and do not write depth.
  gl_.Enable(GL_BLEND);
  gl_.DepthMask(GL_FALSE);
  triangles.draw(0, indices);
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_BLEND);
}

void ScenePainter::drawSheets(const SheetList& sheets, const Frame& frame) {
  if (sheets.index.empty()) return;
  const ShaderProgram& program = frame.programs.sheet;
  setLighting(program, frame, targets_->radiance);
  textures_.bindFibres();
  program.set("fibreMap", static_cast<int>(fibreUnit));
  sheets_.upload(sheets);
  drawBlended(sheets_, sheets.index.size());
}

void ScenePainter::drawSmoke(const SmokeList& smoke, const Frame& frame) const {
  if (smoke.index.empty()) return;
  setLighting(frame.programs.smoke, frame, targets_->radiance);
  smoke_.upload(smoke);
  drawBlended(smoke_, smoke.index.size());
}

void ScenePainter::makeReady(const DrawList& list, const Frame& frame) {
  gl_.Enable(GL_SCISSOR_TEST);
  gl_.Scissor(0, 0, 0, 0);
  for (const DrawPart& part : looksToCome(list)) drawLit(part, frame, targets_->radiance);
  drawSheets({std::vector<SheetVertex>(3), {0, 1, 2}}, frame);
  drawSmoke({std::vector<SmokeVertex>(3), {0, 1, 2}}, frame);
  ready_ = true;
}

void ScenePainter::compose(const Frame& frame) const {
  const PictureTargets& targets = *targets_;
  clear(*targets.picture, GL_COLOR_BUFFER_BIT, frame.sight.halfX > 0.0F ? 1.0F : 0.0F);
  begin(*targets.picture, frame);
  const ShaderProgram& program = frame.programs.compose;
  program.use();
  targets.radiance.sampleColour(depthUnit);
  program.set("radianceMap", static_cast<int>(depthUnit));
  setField(program, frame.sight, 1.0F);
  drawPicture();
}

Image ScenePainter::paint(const DrawList& list, const Sight& sight, double verticalFieldOfView, int width, int height,
                          const RenderSettings& settings) {
  draw(list, sight, verticalFieldOfView, width, height, settings);
  Image image{width, height,
              std::vector<std::uint8_t>(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  gl_.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  if (gl_.GetError() != GL_NO_ERROR)
    throw Error(ErrorKind::failure, "rendering: OpenGL reported an error; is memory short?");
  if (settings.quality == Quality::interactive) smoother_.smooth(image);
  return image;
}

void ScenePainter::draw(const DrawList& list, const Sight& sight, double verticalFieldOfView, int width, int height,
                        const RenderSettings& settings) {
  const bool film = settings.quality == Quality::film;
  prepareTargets(width, height, settings.quality);
  surfaces_.upload(list);
  textures_.bindNoise(settings.quality);

  Frame frame{film ? *film_ : *interactive_, sight};
  frame.focalY = static_cast<float>(1.0 / std::tan(0.5 * verticalFieldOfView));
  frame.focalX = frame.focalY * static_cast<float>(height) / static_cast<float>(width);
  frame.shadowFocal = static_cast<float>(1.0 / sight.lit());
  frame.referenceDistance = list.referenceDistance;

  clear(targets_->shadow, GL_DEPTH_BUFFER_BIT);
  setCamera(frame.programs.shadow, frame.shadowFocal, frame.shadowFocal, lightX, lightY);
  drawParts(list, false);
  targets_->shadow.sampleDepth(shadowUnit);

  // Rows of an Image go from top to bottom, OpenGL's from bottom to top: film flips them when composing; interactive
  // quality renders upside down, which reverses the orientation of triangles.
  if (!film) frame.focalY = -frame.focalY;
  gl_.FrontFace(film ? GL_CCW : GL_CW);
  drawOcclusion(list, frame);
  drawSurfaces(list, frame);
  drawSheets(list.sheets, frame);
  drawSmoke(list.smoke, frame);
  if (settings.ready && !ready_ && !list.part.empty()) makeReady(list, frame);
  gl_.FrontFace(GL_CCW);
  if (film) compose(frame);
}

}  // namespace calot::gui
