// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/draw_list.h"

#include <algorithm>
#include <cmath>

#include "gui/render/cavity_mesh.h"
#include "gui/render/clip_mesh.h"
#include "gui/render/instrument_mesh.h"

namespace calot::gui {
namespace {

/// Beyond it, char looks the same; more at one vertex would only widen the spot to its whole triangles.
constexpr float mostCharred = 1.6F;

class Builder {
 public:
  explicit Builder(const CameraSample& camera)
      : origin_(camera.position), toCamera_(camera.orientation.normalized().conjugate().toRotationMatrix()) {}

  [[nodiscard]] Vec3 point(const Vec3& p_W) const { return toCamera_ * (p_W - origin_); }
  [[nodiscard]] Vec3 direction(const Vec3& d_W) const { return toCamera_ * d_W; }

  void begin() { base_ = static_cast<std::uint32_t>(list.vertex.size()); }
  void add(const Vec3& p_C, const Vec3& n_C, const Vec3& rest, const Vec3& restNormal, float charred = 0.0F,
           float face = 0.0F) {
    DrawVertex v{};
    for (int a = 0; a < 3; ++a) {
      v.position[a] = static_cast<float>(p_C[a]);
      v.normal[a] = static_cast<float>(n_C[a]);
      v.rest[a] = static_cast<float>(rest[a]);
      v.restNormal[a] = static_cast<float>(restNormal[a]);
    }
    v.charred = charred;
    v.face = face;
    list.vertex.push_back(v);
  }
  void end(Appearance appearance, const std::vector<Index3>& triangles, bool harmed = false) {
    DrawPart part;
    part.harmed = harmed;
    part.appearance = appearance;
    part.firstIndex = static_cast<std::uint32_t>(list.index.size());
    for (const Index3& t : triangles)
      for (int a = 0; a < 3; ++a) list.index.push_back(base_ + static_cast<std::uint32_t>(t[a]));
    part.indexCount = static_cast<std::uint32_t>(list.index.size()) - part.firstIndex;
    list.part.push_back(part);
  }

  DrawList list;

 private:
  Vec3 origin_;
  Mat3 toCamera_;
  std::uint32_t base_ = 0;
};

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

std::vector<Vec3> vertexNormals(const std::vector<Vec3>& position, const std::vector<Index3>& triangle) {
  std::vector<Vec3> normal(position.size(), Vec3::Zero());
  const auto at = [](auto& list, int i) -> auto& { return list[static_cast<std::size_t>(i)]; };
  for (const Index3& t : triangle) {
    const Vec3 area = (at(position, t[1]) - at(position, t[0])).cross(at(position, t[2]) - at(position, t[0]));
    for (int a = 0; a < 3; ++a) at(normal, t[a]) += area;
  }
  for (Vec3& n : normal) {
    const double length = n.norm();
    n = length > 1e-30 ? Vec3(n / length) : Vec3::UnitZ();
  }
  return normal;
}

DrawList makeDrawList(const SceneView& view, bool cavity) {
  Builder builder(view.camera);
  for (const SurfaceView& surface : view.surface) {
    const std::vector<Vec3> normal = vertexNormals(surface.position, surface.triangle);
    const std::vector<Vec3> restNormal = vertexNormals(surface.rest, surface.triangle);
    builder.begin();
    for (std::size_t v = 0; v < surface.position.size(); ++v)
      builder.add(builder.point(surface.position[v]), builder.direction(normal[v]), surface.rest[v], restNormal[v],
                  surface.charred.empty() ? 0.0F : std::clamp(surface.charred[v], 0.0F, mostCharred),
                  surface.face.empty() ? 0.0F : surface.face[v]);
    builder.end(appearanceOf(surface.appearance), surface.triangle, !surface.charred.empty() || !surface.face.empty());
  }
  builder.list.referenceDistance = referenceDistance(builder.list.vertex);

  for (const ClipView& clip : view.clip) {
    const Mesh mesh = makeClip(clip);
    const Quat q = clip.pose.orientation.normalized();
    builder.begin();
    // Metal is brushed along z of what its texture sticks to: here along the legs.
    const auto lengthwise = [](const Vec3& p) { return Vec3(p.x(), p.z(), p.y()); };
    for (std::size_t v = 0; v < mesh.position.size(); ++v)
      builder.add(builder.point(clip.pose.position + q * mesh.position[v]), builder.direction(q * mesh.normal[v]),
                  lengthwise(mesh.position[v]), lengthwise(mesh.normal[v]));
    builder.end(Appearance::titanium, mesh.triangle);
  }

  for (const InstrumentView& instrument : view.instrument) {
    if (instrument.kind == InstrumentKind::none) continue;
    const Quat q = instrument.pose.orientation.normalized();
    for (const InstrumentPart& part : makeInstrument(instrument)) {
      builder.begin();
      for (std::size_t v = 0; v < part.mesh.position.size(); ++v)
        builder.add(builder.point(instrument.pose.position + q * part.mesh.position[v]),
                    builder.direction(q * part.mesh.normal[v]), part.mesh.position[v], part.mesh.normal[v]);
      builder.end(part.appearance, part.mesh.triangle);
    }
  }

  if (cavity) {
    const Mesh wall = makeCavity(view);
    builder.begin();
    for (std::size_t v = 0; v < wall.position.size(); ++v)
      builder.add(builder.point(wall.position[v]), builder.direction(wall.normal[v]), wall.position[v], wall.normal[v]);
    builder.end(Appearance::cavity, wall.triangle);
  }
  builder.list.sheets = makeSheetList(view);
  return std::move(builder.list);
}

}  // namespace calot::gui
