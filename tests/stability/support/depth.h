// SPDX-License-Identifier: GPL-3.0-or-later
// How deep instruments stand in organs, measured without the contact search: points along every capsule's axis against
// the exact signed distance of the deformed skin.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/geometry/surface_distance.h"
#include "sim/instruments/instrument_shape.h"
#include "sim/step/contact_block.h"
#include "sim/step/placed_instrument.h"
#include "sim/step/stepper.h"

namespace calot::test {

inline Vec3 tipAxis(const Pose& pose) { return pose.orientation * Vec3::UnitZ(); }

/// The deepest dimple that a hand presses (m).
inline double deepestDimple(const TouchState& touches) {
  double deepest = 0.0;
  for (const Vec3& dimple : touches.dimple) deepest = std::max(deepest, dimple.norm());
  return deepest;
}

/// Depth of the deepest point of an instrument (m) beyond the dimples that it presses, 0 outside. Jaws that hold this
/// organ are not counted against it.
inline double instrumentDepth(const Model& model, const State& state, std::size_t hand) {
  const HandState& h = state.hand[hand];
  const HandDescription& description = model.scene().hands[hand];
  const Pose pose = simulatedPose(h.instrument);
  const InstrumentShape shape = placed(instrumentShape(h.instrument.kind, h.instrument.jaw, description.shaftRadius,
                                                       (pose.position - description.port).norm()),
                                       pose);
  double deepest = 0.0;
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    const OrganModel& organ = model.organs()[o];
    TriangleMesh mesh;
    organ.embedding.map(state.organ[o].position, mesh.vertex);
    mesh.triangle = organ.surface.triangles();
    Box bounds;
    for (const Vec3& p : mesh.vertex) bounds.include(p);
    std::vector<std::pair<Vec3, double>> point;
    for (const Capsule& c : shape.capsules()) {
      const bool jaw = c.part == Capsule::Part::upperJaw || c.part == Capsule::Part::lowerJaw;
      if (jaw && h.grasp.structure == o) continue;
      const int pieces = 1 + static_cast<int>((c.p1 - c.p0).norm() / 0.001);
      for (int k = 0; k <= pieces; ++k) {
        const Vec3 p = c.p0 + (static_cast<double>(k) / pieces) * (c.p1 - c.p0) + dimpleOf(h.touches, o, c.piece);
        const Vec3 out = (bounds.lower - p).cwiseMax(p - bounds.upper);
        if (out.maxCoeff() < c.radius) point.emplace_back(p, c.radius);
      }
    }
    if (point.empty()) continue;
    const SurfaceDistance distance(std::move(mesh), InsideRule::pseudonormal);
    for (const auto& [p, radius] : point) {
      const SurfaceDistance::Closest closest = distance.closest(p);
      double depth = radius - distance.signedDistance(p, closest);
      // Where the surface is folded, pseudonormals may take outside for inside: the winding number decides.
      if (depth > radius && distance.windingNumber(p) < 0.5) depth = radius - std::sqrt(closest.on.squaredDistance);
      deepest = std::max(deepest, depth);
    }
  }
  return deepest;
}

/// Does the axis of the whole shaft, from the port to the tip, pass through the skin of an organ?
inline bool shaftPierces(const Model& model, const State& state, std::size_t hand, std::size_t o) {
  std::vector<Vec3> skin;
  model.organs()[o].embedding.map(state.organ[o].position, skin);
  const Vec3 from = model.scene().hands[hand].port;
  const Pose pose = simulatedPose(state.hand[hand].instrument);
  const Vec3 way = pose.position - 1e-3 * tipAxis(pose) - from;
  for (const Index3& t : model.organs()[o].surface.triangles()) {
    const Vec3& a = skin[static_cast<std::size_t>(t[0])];
    const Vec3 e = skin[static_cast<std::size_t>(t[1])] - a;
    const Vec3 f = skin[static_cast<std::size_t>(t[2])] - a;
    const Vec3 p = way.cross(f);
    const double determinant = e.dot(p);
    if (std::abs(determinant) < 1e-18) continue;
    const Vec3 s = from - a;
    const double u = s.dot(p) / determinant;
    const Vec3 q = s.cross(e);
    const double v = way.dot(q) / determinant;
    const double k = f.dot(q) / determinant;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && k > 0.0 && k < 1.0) return true;
  }
  return false;
}

}  // namespace calot::test
