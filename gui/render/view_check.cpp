// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/view_check.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "gui/render/renderer.h"
#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

template <class... Values>
[[noreturn]] void refuse(fmt::format_string<Values...> what, Values&&... values) {
  throw Error(ErrorKind::damaged, "scene view: " + fmt::format(what, std::forward<Values>(values)...));
}

// A kilometre is far outside every scene; beyond it single precision on the graphics side has no millimetres left.
constexpr double farthestPoint = 1e3;

bool drawable(const Vec3& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() <= farthestPoint; }
bool drawable(const Quat& q) { return q.coeffs().allFinite() && q.norm() > 0.5 && q.norm() < 2.0; }

void checkSurface(const SurfaceView& surface) {
  if (surface.rest.size() != surface.position.size())
    refuse("surface '{}' has {} vertices but {} at rest; give both", surface.organ, surface.position.size(),
           surface.rest.size());
  for (std::size_t v = 0; v < surface.position.size(); ++v)
    if (!drawable(surface.position[v]) || !drawable(surface.rest[v]))
      refuse("surface '{}', vertex {}: a coordinate is not finite or over 1 km; the step behind it is not valid",
             surface.organ, v);
  const int count = static_cast<int>(surface.position.size());
  for (std::size_t t = 0; t < surface.triangle.size(); ++t)
    if (surface.triangle[t].minCoeff() < 0 || surface.triangle[t].maxCoeff() >= count)
      refuse("surface '{}', triangle {}: names a vertex outside 0 to {}", surface.organ, t, count - 1);
}

void checkHarm(const SurfaceView& surface, const std::vector<float>& values, const char* what, float most) {
  if (values.empty()) return;
  if (values.size() != surface.position.size())
    refuse("surface '{}' has {} vertices but {} values of '{}'; give one each, or none", surface.organ,
           surface.position.size(), values.size(), what);
  for (std::size_t v = 0; v < values.size(); ++v)
    if (!(values[v] >= 0.0F && values[v] <= most))
      refuse("surface '{}', vertex {}: '{}' is {}; give a number from 0 to {}", surface.organ, v, what, values[v],
             most);
}

void checkClip(const ClipView& clip, std::size_t number) {
  const auto fine = [](double size) { return size > 0.0 && size < 0.1; };
  if (!drawable(clip.pose.position) || !drawable(clip.pose.orientation) || !fine(clip.width) || !fine(clip.legs) ||
      !(clip.halfGap >= 0.0 && clip.halfGap < 0.1))
    refuse("clip {}: pose or size is not finite or out of range", number);
}

void checkConnective(const ConnectiveView& connective) {
  const std::size_t strands = connective.strand.size();
  if (connective.condition.size() != strands || connective.alpha.size() != strands)
    refuse("connective tissue '{}' has {} strands but {} conditions and {} alphas; give one of each a strand",
           connective.name, strands, connective.condition.size(), connective.alpha.size());
  for (std::size_t s = 0; s < strands; ++s) {
    if (!drawable(connective.strand[s][0]) || !drawable(connective.strand[s][1]))
      refuse(
          "connective tissue '{}', strand {}: a coordinate is not finite or over 1 km; the step behind it is not valid",
          connective.name, s);
    if (connective.condition[s] > StrandCondition::torn)
      refuse("connective tissue '{}', strand {}: condition {} is not one of attached, burned, torn", connective.name, s,
             static_cast<int>(connective.condition[s]));
    if (!(connective.alpha[s] >= 0.0F && connective.alpha[s] <= 1.0F))
      refuse("connective tissue '{}', strand {}: alpha {}; give one between 0 and 1", connective.name, s,
             connective.alpha[s]);
  }
  for (std::size_t p = 0; p < connective.sheet.size(); ++p)
    for (const std::uint32_t s : connective.sheet[p])
      if (s >= strands)
        refuse("connective tissue '{}', sheet {}: names strand {}, but there are {}", connective.name, p, s, strands);
}

}  // namespace

void checkView(const SceneView& view) {
  if (!drawable(view.camera.position) || !drawable(view.camera.orientation))
    refuse("camera pose: not finite, over 1 km away, or the quaternion is far from unit length");
  if (!(view.verticalFieldOfView > 0.05 && view.verticalFieldOfView < 3.0))
    refuse("vertical field of view {} rad: give one between 0.05 and 3.0 rad", view.verticalFieldOfView);
  for (int h = 0; h < handCount; ++h) {
    const InstrumentView& instrument = view.instrument[static_cast<std::size_t>(h)];
    if (instrument.kind == InstrumentKind::none) continue;
    if (!drawable(instrument.pose.position) || !drawable(instrument.pose.orientation) || !drawable(instrument.port) ||
        !(instrument.radius > 0.0 && instrument.radius < 0.1) || !(instrument.jaw >= -4.0 && instrument.jaw <= 4.0))
      refuse("{} instrument: pose, port, radius or jaw is not finite or out of range",
             handNames[static_cast<std::size_t>(h)]);
  }
  for (const SurfaceView& surface : view.surface) {
    checkSurface(surface);
    checkHarm(surface, surface.charred, "charred", 1e6F);
    checkHarm(surface, surface.face, "face", 2.0F);
  }
  for (std::size_t c = 0; c < view.clip.size(); ++c) checkClip(view.clip[c], c);
  for (const ConnectiveView& connective : view.connective) checkConnective(connective);
}

void checkPictureSize(long long width, long long height) {
  if (width < minSide || height < minSide || width > maxSide || height > maxSide || width * height > maxPixels)
    throw Error(ErrorKind::invalid, fmt::format("picture size {}x{}: give {} to {} pixels a side and at most {} in all",
                                                width, height, minSide, maxSide, maxPixels));
}

void checkSmoke(std::span<const Puff> smoke) {
  for (std::size_t p = 0; p < smoke.size(); ++p)
    if (!drawable(smoke[p].p_W) || !std::isfinite(smoke[p].age) ||
        !(smoke[p].strength >= 0.0 && smoke[p].strength <= 1.0))
      refuse("smoke, puff {}: place or age is not finite, or its strength not from 0 to 1", p);
}

}  // namespace calot::gui
