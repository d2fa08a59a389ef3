// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/fallen_clips.h"

#include <algorithm>
#include <cmath>

#include "sim/geometry/ground.h"

namespace calot::recorder {
namespace {

constexpr double gravity = 9.81;      // m/s^2
constexpr double deepestFall = 0.25;  // no picture shows what lies deeper (m)
constexpr double sunk = 0.002;        // a tip that touches tissue is in it as far as this (m)
constexpr std::size_t most = 50;      // more than an operator loses; a damaged recording may have any number
constexpr double turn = 2.399963;     // golden angle: no two lie alike (rad)

/// The highest surface below a point.
Ground groundIn(const SceneView& view, const Vec3& p) {
  Ground ground;
  for (const SurfaceView& surface : view.surface) {
    const Ground own = groundBelow(surface.position, surface.triangle, p, view.down, sunk);
    if (own.below < ground.below) ground = own;
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
    const double way = age > 0.0 ? std::min(0.5 * gravity * age * age, deepestFall) : 0.0;
    const Ground ground = groundIn(view, lost_[i].p_W);
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
