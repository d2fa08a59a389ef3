// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/fallen_clips.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace calot::recorder {
namespace {

constexpr double gravity = 9.81;     // m/s^2
constexpr double outOfSight = 0.25;  // farther than this below, nothing is seen any more (m)
constexpr double sunk = 0.002;       // a tip that touches tissue is in it as far as this (m)
constexpr std::size_t most = 50;     // more than an operator loses; a damaged recording may have any number
constexpr double turn = 2.399963;    // golden angle: no two lie alike (rad)

struct Ground {
  double below = std::numeric_limits<double>::infinity();  ///< how far down (m)
  Vec3 normal = Vec3::Zero();
};

/// How far along a ray from p it meets a triangle (Moeller and Trumbore 1997), or nothing.
std::optional<double> meet(const Vec3& p, const Vec3& along, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, across = along.cross(ac);
  const double volume = ab.dot(across);
  if (!(std::abs(volume) > 1e-18)) return std::nullopt;
  const Vec3 from = p - a, side = from.cross(ab);
  const double u = from.dot(across) / volume, v = along.dot(side) / volume;
  if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0)) return std::nullopt;
  return ac.dot(side) / volume;
}

/// The highest surface below a point.
Ground groundBelow(const SceneView& view, const Vec3& p) {
  Ground ground;
  for (const SurfaceView& surface : view.surface) {
    const auto vertices = static_cast<std::uint32_t>(surface.position.size());
    for (const Index3& t : surface.triangle) {
      if (std::max({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                    static_cast<std::uint32_t>(t[2])}) >= vertices)
        continue;  // whoever draws the view refuses it
      const Vec3 &a = surface.position[static_cast<std::size_t>(t[0])],
                 &b = surface.position[static_cast<std::size_t>(t[1])],
                 &c = surface.position[static_cast<std::size_t>(t[2])];
      const auto below = meet(p, view.down, a, b, c);
      if (!below || *below < -sunk || *below >= ground.below) continue;
      const Vec3 normal = (b - a).cross(c - a).normalized();
      if (normal.dot(view.down) < 0.0) ground = {*below, normal};
    }
  }
  return ground;
}

}  // namespace

FallenClips::FallenClips(const ClipDescription& clip, double stepSeconds) : stepSeconds_(stepSeconds) {
  clip_.width = clip.width;
  clip_.legs = clip.legs;
}

void FallenClips::add(const Event& event) {
  if (event.kind == EventKind::clipDropped && event.position.allFinite() && lost_.size() < most)
    lost_.push_back({static_cast<double>(event.step + 1) * stepSeconds_, event.position});
}

void FallenClips::show(SceneView& view) const {
  for (std::size_t i = 0; i < lost_.size(); ++i) {
    const double age = view.time - lost_[i].time;
    if (age < -0.5 * stepSeconds_) continue;
    const double way = age > 0.0 ? 0.5 * gravity * age * age : 0.0;
    const Ground ground = groundBelow(view, lost_[i].p_W);
    if (way > outOfSight && ground.below > outOfSight) continue;
    const bool lies = ground.below <= way;
    const Vec3 up = lies ? ground.normal : Vec3(-view.down);
    const Vec3 aside = (std::abs(up.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY()).cross(up).normalized();
    const double angle = turn * static_cast<double>(i);
    const Vec3 legs = std::cos(angle) * aside + std::sin(angle) * up.cross(aside);
    Mat3 axes;
    axes << legs.cross(up), legs, up;
    ClipView& clip = view.clip.emplace_back(clip_);
    clip.pose.orientation = Quat(axes);
    clip.pose.position = lost_[i].p_W + (lies ? ground.below : way) * view.down + 0.5 * clip.width * up;
  }
}

}  // namespace calot::recorder
