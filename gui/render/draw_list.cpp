// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/draw_list.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "gui/render/clip_mesh.h"
#include "gui/render/instrument_mesh.h"

namespace calot::gui {
namespace {

/// Beyond it, char looks the same; more at one vertex would only widen the spot to its whole triangles.
constexpr float mostCharred = 1.6F;

// The endoscope's automatic exposure: the distance whose inverse square is the mean over what lies ahead and faces the
// lens, weighted towards the middle of the picture.
float referenceDistance(const std::vector<DrawVertex>& vertices) {
  double weights = 0.0, light = 0.0;
  for (const DrawVertex& v : vertices) {
    const Vec3 p(v.position[0], v.position[1], v.position[2]);
    const double distance = p.norm();
    if (p.z() < 0.01 || distance < 0.01) continue;
    const Vec3 n(v.normal[0], v.normal[1], v.normal[2]);
    const double towards = -n.dot(p) / distance;
    if (towards <= 0.0) continue;
    const double cosine = p.z() / distance;
    const double c4 = cosine * cosine * cosine * cosine;
    const double weight = towards * c4 * c4 * c4;
    weights += weight;
    light += weight / (distance * distance);
  }
  if (weights <= 0.0) return 0.1F;
  return static_cast<float>(std::clamp(std::sqrt(weights / light), 0.02, 0.6));
}

}  // namespace

Appearance appearanceOf(const std::string& word) {
  if (word == "liver") return Appearance::liver;
  if (word == "gallbladder") return Appearance::gallbladder;
  if (word == "duct") return Appearance::duct;
  if (word == "artery") return Appearance::artery;
  if (word == "fat") return Appearance::fat;
  return Appearance::tissue;
}

void DrawListMaker::addVertex(const Vec3& p_C, const Vec3& n_C, const Vec3& rest, const Vec3& restNormal, float charred,
                              float face) {
  DrawVertex v{};
  for (int a = 0; a < 3; ++a) {
    v.position[a] = static_cast<float>(p_C[a]);
    v.normal[a] = static_cast<float>(n_C[a]);
    v.rest[a] = static_cast<float>(rest[a]);
    v.restNormal[a] = static_cast<float>(restNormal[a]);
  }
  v.charred = charred;
  v.face = face;
  list_.vertex.push_back(v);
}

void DrawListMaker::addPart(DrawPart part, const std::vector<Index3>& triangles) {
  part.firstIndex = static_cast<std::uint32_t>(list_.index.size());
  for (const Index3& t : triangles)
    for (int a = 0; a < 3; ++a) list_.index.push_back(base_ + static_cast<std::uint32_t>(t[a]));
  part.indexCount = static_cast<std::uint32_t>(list_.index.size()) - part.firstIndex;
  if (part.indexCount > 0) list_.part.push_back(part);
}

void DrawListMaker::addSurface(const SurfaceView& surface, SurfaceForm& form) {
  form.update(surface.rest, surface.triangle);
  const std::vector<Vec3> normal = vertexNormals(surface.position, surface.triangle);
  begin();
  for (std::size_t v = 0; v < surface.position.size(); ++v)
    addVertex(point(surface.position[v]), direction(normal[v]), surface.rest[v], form.restNormal()[v],
              surface.charred.empty() ? 0.0F : std::clamp(surface.charred[v], 0.0F, mostCharred),
              surface.face.empty() ? 0.0F : surface.face[v]);
  DrawPart part;
  part.appearance = appearanceOf(surface.appearance);
  part.oneSided = form.closed();
  if (surface.charred.empty() && surface.face.empty()) {
    addPart(part, surface.triangle);
    return;
  }
  // Only the triangles that are charred or parted pay for that.
  const auto harmed = [&](int i) {
    const DrawVertex& vertex = list_.vertex[base_ + static_cast<std::uint32_t>(i)];
    return vertex.charred > 0.0F || vertex.face > 0.0F;
  };
  std::array<std::vector<Index3>, 2> split;
  for (const Index3& t : surface.triangle) split[harmed(t[0]) || harmed(t[1]) || harmed(t[2]) ? 1 : 0].push_back(t);
  addPart(part, split[0]);
  part.harmed = true;
  addPart(part, split[1]);
}

void DrawListMaker::addMesh(const Mesh& mesh, Appearance appearance, const Pose& pose, bool lengthwise) {
  const Quat q = pose.orientation.normalized();
  // Metal is brushed along z of what its texture sticks to; lengthwise: along y of the mesh.
  const auto brushed = [&](const Vec3& p) { return lengthwise ? Vec3(p.x(), p.z(), p.y()) : p; };
  begin();
  for (std::size_t v = 0; v < mesh.position.size(); ++v)
    addVertex(point(pose.position + q * mesh.position[v]), direction(q * mesh.normal[v]), brushed(mesh.position[v]),
              brushed(mesh.normal[v]));
  DrawPart part;
  part.appearance = appearance;
  addPart(part, mesh.triangle);
}

void DrawListMaker::addCavity(const SceneView& view, double aspect) {
  if (const CavityShape shape = cavityShape(view); shape != cavityShape_) {
    cavity_ = makeCavity(shape);
    cavityShape_ = shape;
  }
  begin();
  for (std::size_t v = 0; v < cavity_.position.size(); ++v)
    addVertex(point(cavity_.position[v]), direction(cavity_.normal[v]), cavity_.position[v], cavity_.normal[v]);
  // Most of it lies beside or behind the camera.
  const double up = std::tan(0.5 * view.verticalFieldOfView), aside = up * aspect;
  const auto outside = [&](int i) {  // of which sides of the field of view
    const float* const p = list_.vertex[base_ + static_cast<std::uint32_t>(i)].position;
    const double x = static_cast<double>(p[0]), y = static_cast<double>(p[1]), z = static_cast<double>(p[2]);
    return (z <= 0.0 ? 1U : 0U) | (x > aside * z ? 2U : 0U) | (-x > aside * z ? 4U : 0U) | (y > up * z ? 8U : 0U) |
           (-y > up * z ? 16U : 0U);
  };
  seen_.clear();
  for (const Index3& t : cavity_.triangle)
    if ((outside(t[0]) & outside(t[1]) & outside(t[2])) == 0U) seen_.push_back(t);
  DrawPart part;
  part.appearance = Appearance::cavity;
  part.oneSided = true;
  addPart(part, seen_);
}

const DrawList& DrawListMaker::make(const SceneView& view, double aspect, bool cavity, std::span<const Puff> smoke) {
  list_.vertex.clear();
  list_.index.clear();
  list_.part.clear();
  origin_ = view.camera.position;
  toCamera_ = view.camera.orientation.normalized().conjugate().toRotationMatrix();
  form_.resize(view.surface.size());
  for (std::size_t s = 0; s < view.surface.size(); ++s) addSurface(view.surface[s], form_[s]);
  list_.referenceDistance = referenceDistance(list_.vertex);
  for (const ClipView& clip : view.clip) addMesh(makeClip(clip), Appearance::titanium, clip.pose, true);
  for (const InstrumentView& instrument : view.instrument) {
    if (instrument.kind == InstrumentKind::none) continue;
    for (const InstrumentPart& part : makeInstrument(instrument))
      addMesh(part.mesh, part.appearance, instrument.pose, false);
  }
  // Scenes name the large organs first, which lie behind: what is hidden costs little where it comes later.
  std::reverse(list_.part.begin(), list_.part.end());
  if (cavity) addCavity(view, aspect);
  list_.sheets = makeSheetList(view);
  list_.smoke = makeSmokeList(view.camera, smoke);
  return list_;
}

}  // namespace calot::gui
