// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/wire.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "sim/instruments/instruments.h"

namespace calot::recorder::wire {

namespace {

Rotation rotationOf(const Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }
Quat quatOf(const Rotation& r) { return {r[0], r[1], r[2], r[3]}; }

/// Recorded samples lie on a grid: their norm is near 1 only (schemas/recording.md).
bool isRotation(const Rotation& r) {
  const double norm = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
  return std::abs(norm - 1.0) <= 1e-3;
}

bool fits(const Surface& s) {
  const std::size_t vertices = s.position.size();
  if (s.rest.size() != vertices || (!s.charred.empty() && s.charred.size() != vertices) ||
      (!s.face.empty() && s.face.size() != vertices) || s.role > StructureRole::cysticPlate)
    return false;
  return std::all_of(s.triangle.begin(), s.triangle.end(), [&](const Index3& t) {
    return t.minCoeff() >= 0 && static_cast<std::size_t>(t.maxCoeff()) < vertices;
  });
}

bool fits(const Bed& b) {
  const std::size_t strands = b.strand.size();
  const auto isCondition = [](StrandCondition c) { return c <= StrandCondition::torn; };
  const auto isSheet = [&](const auto& s) { return s[0] < strands && s[1] < strands; };
  return b.condition.size() == strands && b.alpha.size() == strands &&
         std::all_of(b.condition.begin(), b.condition.end(), isCondition) &&
         std::all_of(b.sheet.begin(), b.sheet.end(), isSheet);
}

}  // namespace

void toWire(std::span<const TickSamples> samples, std::span<const TickOutcome> logged, std::vector<Tick>& out) {
  out.resize(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Tick& tick = out[i];
    for (std::size_t h = 0; h < handCount; ++h) {
      const InstrumentSample& s = samples[i].hand[h];
      tick.hand[h] = {s.position,
                      rotationOf(s.orientation),
                      s.jaw,
                      static_cast<std::uint8_t>(s.instrument),
                      s.buttons,
                      static_cast<std::uint8_t>(s.valid ? 1 : 0),
                      logged[i].hand[h].contactSet};
    }
    tick.cameraPosition = samples[i].camera.position;
    tick.cameraOrientation = rotationOf(samples[i].camera.orientation);
    tick.lateness = logged[i].lateness;
  }
}

bool fromWire(const Tick& tick, TickSamples& samples, TickOutcome& logged) {
  for (std::size_t h = 0; h < handCount; ++h) {
    const HandSample& hand = tick.hand[h];
    if (!hand.position.allFinite() || !isRotation(hand.orientation) || !std::isfinite(hand.jaw) ||
        !isInstrumentNumber(hand.instrument) || hand.valid > 1)
      return false;
    samples.hand[h] = {hand.position, quatOf(hand.orientation), hand.jaw, static_cast<InstrumentKind>(hand.instrument),
                       hand.buttons,  hand.valid == 1};
    logged.hand[h].contactSet = hand.set;
  }
  if (!tick.cameraPosition.allFinite() || !isRotation(tick.cameraOrientation) || !std::isfinite(tick.lateness))
    return false;
  samples.camera = {tick.cameraPosition, quatOf(tick.cameraOrientation)};
  logged.lateness = tick.lateness;
  return true;
}

Event toWire(const calot::Event& event) {
  return {event.step, static_cast<std::uint8_t>(event.kind), event.hand, event.subject, event.position, event.value};
}

calot::Event fromWire(const Event& event) {
  return {event.step, static_cast<EventKind>(event.event), event.hand, event.subject, event.position, event.value};
}

View toWire(const SceneView& view) {
  View out;
  out.step = view.step;
  out.time = view.time;
  for (const SurfaceView& surface : view.surface) out.surface.push_back({surface});
  for (const ConnectiveView& bed : view.connective) out.bed.push_back({bed});
  for (const ClipView& c : view.clip)
    out.clip.push_back({c.pose.position, rotationOf(c.pose.orientation), c.width, c.legs, c.halfGap});
  for (std::size_t h = 0; h < handCount; ++h) {
    const InstrumentView& i = view.instrument[h];
    out.instrument[h] = {static_cast<std::uint8_t>(i.kind),
                         i.pose.position,
                         rotationOf(i.pose.orientation),
                         i.port,
                         i.radius,
                         i.jaw,
                         static_cast<std::uint8_t>(i.touching ? 1 : 0)};
  }
  out.cameraPosition = view.camera.position;
  out.cameraOrientation = rotationOf(view.camera.orientation);
  out.fieldOfView = view.verticalFieldOfView;
  return out;
}

bool fromWire(View view, SceneView& out) {
  out = {};
  out.step = view.step;
  out.time = view.time;
  const auto allFit = [](const auto& parts) {
    return std::all_of(parts.begin(), parts.end(), [](const auto& part) { return fits(part); });
  };
  if (!allFit(view.surface) || !allFit(view.bed)) return false;
  out.surface.assign(std::make_move_iterator(view.surface.begin()), std::make_move_iterator(view.surface.end()));
  out.connective.assign(std::make_move_iterator(view.bed.begin()), std::make_move_iterator(view.bed.end()));
  for (const Clip& c : view.clip) out.clip.push_back({{c.position, quatOf(c.orientation)}, c.width, c.legs, c.halfGap});
  for (std::size_t h = 0; h < handCount; ++h) {
    const Instrument& i = view.instrument[h];
    if (!isInstrumentNumber(i.instrument) || i.touching > 1) return false;
    out.instrument[h] = {static_cast<InstrumentKind>(i.instrument),
                         {i.position, quatOf(i.orientation)},
                         i.port,
                         i.radius,
                         i.jaw,
                         i.touching == 1};
  }
  out.camera = {view.cameraPosition, quatOf(view.cameraOrientation)};
  out.verticalFieldOfView = view.fieldOfView;
  return true;
}

}  // namespace calot::recorder::wire
