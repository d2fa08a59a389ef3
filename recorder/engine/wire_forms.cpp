// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/wire_forms.h"

#include <algorithm>
#include <cmath>
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
      (!s.face.empty() && s.face.size() != vertices) || s.role > static_cast<std::uint8_t>(StructureRole::cysticPlate))
    return false;
  return std::all_of(s.triangle.begin(), s.triangle.end(),
                     [&](const auto& t) { return t[0] < vertices && t[1] < vertices && t[2] < vertices; });
}

bool fits(const Bed& b) {
  const std::size_t strands = b.strand.size();
  const auto isCondition = [](std::uint8_t c) { return c <= static_cast<std::uint8_t>(StrandCondition::torn); };
  const auto isSheet = [&](const auto& s) { return s[0] < strands && s[1] < strands; };
  return b.condition.size() == strands && b.alpha.size() == strands &&
         std::all_of(b.condition.begin(), b.condition.end(), isCondition) &&
         std::all_of(b.sheet.begin(), b.sheet.end(), isSheet);
}

}  // namespace

Tick toWire(const TickSamples& samples, const TickOutcome& logged) {
  Tick tick;
  for (std::size_t h = 0; h < handCount; ++h) {
    const InstrumentSample& s = samples.hand[h];
    tick.hand[h] = {s.position,
                    rotationOf(s.orientation),
                    s.jaw,
                    static_cast<std::uint8_t>(s.instrument),
                    s.buttons,
                    static_cast<std::uint8_t>(s.valid ? 1 : 0),
                    logged.hand[h].contactSet};
  }
  tick.cameraPosition = samples.camera.position;
  tick.cameraOrientation = rotationOf(samples.camera.orientation);
  tick.lateness = logged.lateness;
  return tick;
}

void toWire(std::span<const TickSamples> samples, std::span<const TickOutcome> logged, std::vector<Tick>& out) {
  out.clear();
  for (std::size_t i = 0; i < samples.size(); ++i) out.push_back(toWire(samples[i], logged[i]));
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
  for (const SurfaceView& s : view.surface) {
    Surface& surface = out.surface.emplace_back();
    surface.structure = s.organ;
    surface.appearance = s.appearance;
    surface.role = static_cast<std::uint8_t>(s.role);
    surface.position = s.position;
    surface.rest = s.rest;
    for (const Index3& t : s.triangle) {
      surface.triangle.push_back(
          {static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]), static_cast<std::uint32_t>(t[2])});
    }
    surface.charred = s.charred;
    surface.face = s.face;
  }
  for (const ConnectiveView& c : view.connective) {
    Bed& bed = out.bed.emplace_back();
    bed.name = c.name;
    bed.strand = c.strand;
    for (const StrandCondition condition : c.condition) bed.condition.push_back(static_cast<std::uint8_t>(condition));
    bed.alpha = c.alpha;
    bed.sheet = c.sheet;
  }
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
  for (Surface& s : view.surface) {
    if (!fits(s)) return false;
    SurfaceView& surface = out.surface.emplace_back();
    surface.organ = std::move(s.structure);
    surface.appearance = std::move(s.appearance);
    surface.role = static_cast<StructureRole>(s.role);
    surface.position = std::move(s.position);
    surface.rest = std::move(s.rest);
    for (const auto& t : s.triangle)
      surface.triangle.emplace_back(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
    surface.charred = std::move(s.charred);
    surface.face = std::move(s.face);
  }
  for (Bed& b : view.bed) {
    if (!fits(b)) return false;
    ConnectiveView& bed = out.connective.emplace_back();
    bed.name = std::move(b.name);
    bed.strand = std::move(b.strand);
    for (const std::uint8_t condition : b.condition) bed.condition.push_back(static_cast<StrandCondition>(condition));
    bed.alpha = std::move(b.alpha);
    bed.sheet = std::move(b.sheet);
  }
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
