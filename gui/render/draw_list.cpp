// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/draw_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <map>
#include <numbers>

#include "gui/render/instrument_mesh.h"

namespace calot::gui {
namespace {

constexpr double period = 4.0;                      // s from drop to drop
constexpr double falling = 0.09;                    // s that a drop is seen falling
constexpr double smallest = 0.45, largest = 0.85;   // radius of a drop over the vessel's
constexpr double gravity = 9.81;                    // m/s^2
constexpr double narrow = 0.0030, wider = 0.16;     // half width of the stain at the face (m), and more per m below
constexpr double above = 0.0020, farthest = 0.045;  // m above and below the face that it reaches
constexpr double wave = 0.013, speed = 0.009;       // from wave to wave of what runs (m), and how fast they are (m/s)
constexpr double fresh = 0.22;                      // share of the stain that comes and goes with them

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Pointed above, round below.
Mesh drop(double radius) {
  constexpr int rings = 10, around = 14;
  std::vector<Ring> skin;
  for (int i = 0; i < rings; ++i) {
    const double angle = std::numbers::pi * (i + 0.4) / (rings - 0.2);
    const double z = -radius * std::cos(angle) * (angle > 0.5 * std::numbers::pi ? 1.6 : 1.0);
    const double across = radius * std::sin(angle) * (1.0 - 0.28 * std::max(0.0, -std::cos(angle)));
    skin.push_back(superellipse(Vec3(0.0, 0.0, z), across, across, 2.0, around));
  }
  return loft(skin);
}

constexpr double litOverSeen = 1.25;  // width of the light's field over the picture's
/// A shadow falls aside by less than the light is beside the lens (m).
constexpr double shadowReach = 0.006;
constexpr double nearest = 0.004;  // m: nearer than that may be cut by the near plane

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

std::vector<OpenEnd> openEnds(const SceneView& view) {
  std::vector<OpenEnd> ends;
  for (const SurfaceView& surface : view.surface) {
    const auto middleOf = [&](const Index3& t) {
      for (int a = 0; a < 3; ++a)
        if (surface.face[at(t[a])] >= 2.0F) return t[a];
      return -1;
    };
    std::map<int, Vec3> areas;  // twice that of the triangles around a vertex in the middle
    if (!surface.face.empty())
      for (const Index3& t : surface.triangle)
        if (const int middle = middleOf(t); middle >= 0) {
          const auto p = [&](int corner) { return surface.position[at(t[corner])]; };
          areas.try_emplace(middle, Vec3::Zero()).first->second += (p(1) - p(0)).cross(p(2) - p(0));
        }
    for (const auto& [middle, area] : areas) {
      if (!(area.norm() > 0.0)) continue;
      const double radius = std::sqrt(0.5 * area.norm() / std::numbers::pi);
      ends.push_back({surface.position[at(middle)], area.normalized(), radius, view.down, carriesBile(surface.role)});
    }
  }
  return ends;
}

Mesh makeDrop(const OpenEnd& end, double time) {
  const double age = time - period * std::floor(time / period);
  const double hanging = period - falling;
  const double share = std::min(1.0, age / hanging);
  const double radius = end.radius * (smallest + (largest - smallest) * share);
  const double fallen = age > hanging ? 0.5 * gravity * (age - hanging) * (age - hanging) : 0.0;
  return moved(drop(radius), upright(end.down), 0.35 * end.radius * end.outwards + (0.7 * radius + fallen) * end.down);
}

double stainAt(const OpenEnd& end, const Vec3& p_W, double time) {
  const Vec3 d = upright(end.down).conjugate() * (p_W - end.position);
  const double below = -d.z();
  if (below < -above || below > farthest) return 0.0;
  const double aside = std::hypot(d.x(), d.y());
  const double around = std::atan2(d.y(), d.x());
  // Uneven, as what runs over tissue is.
  const double uneven = 1.0 + 0.25 * std::sin(3.0 * around + 260.0 * below) + 0.15 * std::sin(5.0 * around + 1.7);
  const double width = (end.radius + narrow + wider * std::max(below, 0.0)) * uneven;
  if (aside >= width) return 0.0;
  const double inside = 1.0 - aside / width;
  const double ends =
      std::clamp((farthest - below) / (0.4 * farthest), 0.0, 1.0) * std::clamp((below + above) / above, 0.0, 1.0);
  const double runs = 0.5 + 0.5 * std::sin(2.0 * std::numbers::pi * (below - speed * time) / wave);
  return std::min(1.0, 1.8 * inside) * ends * (1.0 - fresh * runs);
}

double Sight::lit() const { return litOverSeen * std::max(aside, up); }

Sight sightOf(int width, int height, double verticalFieldOfView, bool field) {
  const double w = width, h = height;
  Sight sight;
  sight.up = std::tan(0.5 * verticalFieldOfView);
  sight.aside = sight.up * w / h;
  if (!field) return sight;
  // The picture outside the field is black, and costs nothing. Wide pictures cut it above and below.
  const double rim = 0.5 * std::min(w, h) * (width == height ? 0.985 : 1.12);
  constexpr double feather = 1.5;
  constexpr double beyond = 8.0;  // pixels, so that passes of half the size have neighbours at the rim
  const double half = (rim + feather + beyond) / std::cos(std::numbers::pi / fieldSides);
  sight.rim = static_cast<float>(rim);
  sight.feather = static_cast<float>(feather);
  sight.halfX = static_cast<float>(2.0 * half / w);
  sight.halfY = static_cast<float>(2.0 * half / h);
  sight.aside *= std::min(1.0, 2.0 * half / w);
  sight.up *= std::min(1.0, 2.0 * half / h);
  return sight;
}

std::uint8_t placeIn(const Sight& sight, const Vec3& p_C) {
  const double x = sight.aside * p_C.z(), y = sight.up * p_C.z();
  const bool within = p_C.z() > nearest && std::abs(p_C.x()) < x && std::abs(p_C.y()) < y;
  const unsigned sides = (p_C.z() <= 0.0 ? 1U : 0U) | (p_C.x() > x + shadowReach ? 2U : 0U) |
                         (-p_C.x() > x + shadowReach ? 4U : 0U) | (p_C.y() > y + shadowReach ? 8U : 0U) |
                         (-p_C.y() > y + shadowReach ? 16U : 0U);
  return static_cast<std::uint8_t>(within ? 0U : sides | Place::edge);
}

bool turnedAway(const Vec3& a, const Vec3& b, const Vec3& c) {
  static const Vec3 light(static_cast<double>(lightX), static_cast<double>(lightY), 0.0);
  const Vec3 normal = (b - a).cross(c - a);
  return normal.dot(a) > 0.0 && normal.dot(a - light) > 0.0;
}

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
  DrawPart part{.appearance = appearanceOf(surface.appearance), .oneSided = form.closed};
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
  addPart({.appearance = appearance, .oneSided = true}, mesh.triangle);
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
  if (surroundings) surroundings_.update(view);
  for (const ClipView& clip : view.clip) {
    const bool lost = surroundings && !(clip.halfGap > 0.0);
    addMesh(makeClip(clip), Appearance::titanium, lost ? surroundings_.restOf(clip, view.down) : clip.pose, true);
  }
  for (const OpenEnd& end : open)
    addMesh(makeDrop(end, view.time), end.bile ? Appearance::bile : Appearance::blood, {end.position});
  for (const InstrumentView& instrument : view.instrument) {
    if (instrument.kind == InstrumentKind::none) continue;
    for (const InstrumentPart& part : makeInstrument(instrument)) addMesh(part.mesh, part.appearance, instrument.pose);
  }
  // Scenes list large organs first, which lie behind. Drawn in reverse, hidden ones cost little.
  std::reverse(list_.part.begin(), list_.part.end());
  if (surroundings) {
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
