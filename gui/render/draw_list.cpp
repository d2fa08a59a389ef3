// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/draw_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "gui/render/instrument_mesh.h"

namespace calot::gui {
namespace {

/// A number of a directed side, spread over 64 bits (finaliser of MurmurHash3; Appleby).
std::uint64_t hashOf(int from, int to) {
  std::uint64_t h = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(from)) << 32U) |
                    static_cast<std::uint64_t>(static_cast<std::uint32_t>(to));
  h ^= h >> 33U;
  h *= 0xff51afd7ed558ccdULL;
  h ^= h >> 33U;
  h *= 0xc4ceb9fe1a85ec53ULL;
  h ^= h >> 33U;
  return h;
}

/// Bytewise comparison: a spurious difference only costs time.
template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

}  // namespace

bool isClosed(const std::vector<Index3>& triangle) {
  // If every side has an opposite, both sums are equal. If one has none, they agree only with the probability of
  // a 64-bit hash collision.
  std::uint64_t sum = 0;
  for (const Index3& t : triangle)
    for (int k = 0; k < 3; ++k) sum += hashOf(t[k], t[(k + 1) % 3]) - hashOf(t[(k + 1) % 3], t[k]);
  return sum == 0 && !triangle.empty();
}

void SurfaceForm::update(const SurfaceView& surface) {
  const bool sameTriangles = same(triangle, surface.triangle);
  if (sameTriangles && same(rest, surface.rest)) return;
  if (!sameTriangles) closed = isClosed(surface.triangle);
  rest = surface.rest;
  triangle = surface.triangle;
  restNormal = vertexNormals(rest, triangle);
}

namespace {

/// Above this, char looks the same; more at one vertex would only spread over all its triangles.
constexpr float maxCharred = 1.6F;

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

/// Blood and bile from open vessels cover skin, not the vessels' own cut faces.
float stained(float face, const Vec3& p_W, std::span<const OpenEnd> open, double time) {
  constexpr float most = 0.45F;  // skin, fully stained (SurfaceView::face)
  if (face >= 1.0F) return face;
  for (const OpenEnd& end : open) {
    const float stain = most * static_cast<float>(stainAt(end, p_W, time));
    if (stain > std::abs(face)) face = end.bile ? -stain : stain;
  }
  return face;
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
  place_.push_back(placeIn(sight_, p_C));
}

void DrawListMaker::addPart(DrawPart part, const std::vector<Index3>& triangles) {
  part.firstIndex = static_cast<std::uint32_t>(list_.index.size());
  cut_.clear();
  const auto position = [&](std::uint32_t v) {
    const float* const p = list_.vertex[v].position;
    return Vec3(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
  };
  for (const Index3& t : triangles) {
    std::array<std::uint32_t, 3> corner{};
    for (int a = 0; a < 3; ++a) corner[static_cast<std::size_t>(a)] = base_ + static_cast<std::uint32_t>(t[a]);
    const std::array<std::uint8_t, 3> place{place_[corner[0]], place_[corner[1]], place_[corner[2]]};
    if ((place[0] & place[1] & place[2] & Place::sides) != 0) continue;
    if (part.oneSided && turnedAway(position(corner[0]), position(corner[1]), position(corner[2]))) continue;
    std::vector<std::uint32_t>& list = (place[0] | place[1] | place[2]) == 0 ? list_.index : cut_;
    list.insert(list.end(), corner.begin(), corner.end());
  }
  list_.index.insert(list_.index.end(), cut_.begin(), cut_.end());
  part.indexCount = static_cast<std::uint32_t>(list_.index.size()) - part.firstIndex;
  if (part.indexCount > 0) list_.part.push_back(part);
}

void DrawListMaker::addSurface(const SurfaceView& surface, SurfaceForm& form, std::span<const OpenEnd> open,
                               double time) {
  form.update(surface);
  const std::vector<Vec3> normal = vertexNormals(surface.position, surface.triangle);
  begin();
  for (std::size_t v = 0; v < surface.position.size(); ++v)
    addVertex(point(surface.position[v]), direction(normal[v]), surface.rest[v], form.restNormal[v],
              surface.charred.empty() ? 0.0F : std::clamp(surface.charred[v], 0.0F, maxCharred),
              stained(surface.face.empty() ? 0.0F : surface.face[v], surface.position[v], open, time));
  DrawPart part;
  part.appearance = appearanceOf(surface.appearance);
  part.oneSided = form.closed;
  if (surface.charred.empty() && surface.face.empty() && open.empty()) {
    addPart(part, surface.triangle);
    return;
  }
  // Only charred or parted triangles use the costlier shader.
  const auto harmed = [&](int i) {
    const DrawVertex& vertex = list_.vertex[base_ + static_cast<std::uint32_t>(i)];
    return vertex.charred > 0.0F || vertex.face != 0.0F;
  };
  std::array<std::vector<Index3>, 2> split;
  for (const Index3& t : surface.triangle) split[harmed(t[0]) || harmed(t[1]) || harmed(t[2]) ? 1 : 0].push_back(t);
  addPart(part, split[0]);
  part.harmed = true;
  addPart(part, split[1]);
}

void DrawListMaker::addMesh(const Mesh& mesh, Appearance appearance, const Pose& pose, bool lengthwise) {
  const Quat q = pose.orientation.normalized();
  // Metal is brushed along z of its texture coordinates; lengthwise: along y of the mesh.
  const auto brushed = [&](const Vec3& p) { return lengthwise ? Vec3(p.x(), p.z(), p.y()) : p; };
  begin();
  for (std::size_t v = 0; v < mesh.position.size(); ++v)
    addVertex(point(pose.position + q * mesh.position[v]), direction(q * mesh.normal[v]), brushed(mesh.position[v]),
              brushed(mesh.normal[v]));
  DrawPart part;
  part.appearance = appearance;
  part.oneSided = true;
  addPart(part, mesh.triangle);
}

const DrawList& DrawListMaker::make(const SceneView& view, const Sight& sight, bool surroundings,
                                    std::span<const Puff> smoke) {
  sight_ = sight;
  place_.clear();
  list_.vertex.clear();
  list_.index.clear();
  list_.part.clear();
  origin_ = view.camera.position;
  toCamera_ = view.camera.orientation.normalized().conjugate().toRotationMatrix();
  form_.resize(view.surface.size());
  const std::vector<OpenEnd> open = openEnds(view);
  for (std::size_t s = 0; s < view.surface.size(); ++s) addSurface(view.surface[s], form_[s], open, view.time);
  list_.referenceDistance = referenceDistance(list_.vertex);
  for (const ClipView& clip : view.clip) addMesh(makeClip(clip), Appearance::titanium, clip.pose, true);
  for (const OpenEnd& end : open)
    addMesh(makeDrop(end, view.time), end.bile ? Appearance::bile : Appearance::blood, {end.position});
  for (const InstrumentView& instrument : view.instrument) {
    if (instrument.kind == InstrumentKind::none) continue;
    for (const InstrumentPart& part : makeInstrument(instrument)) addMesh(part.mesh, part.appearance, instrument.pose);
  }
  // Scenes list large organs first, which lie behind. Drawn in reverse, hidden ones cost little.
  std::reverse(list_.part.begin(), list_.part.end());
  if (surroundings) {
    surroundings_.update(view);
    addMesh(surroundings_.viscera.bowel, Appearance::bowel);
    addMesh(surroundings_.viscera.omentum, Appearance::omentum);
    addMesh(surroundings_.ligament, Appearance::cavity);
    addMesh(surroundings_.wall, Appearance::cavity);
  }
  list_.sheets = makeSheetList(view);
  list_.smoke = makeSmokeList(view.camera, view.down, smoke);
  return list_;
}

}  // namespace calot::gui
