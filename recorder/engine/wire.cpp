// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/wire.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "sim/instruments/instruments.h"

namespace calot::recorder::wire {

namespace {

/// Recorded samples lie on a grid: their norm is near 1 only (schemas/recording.md).
bool isRotation(const Quat& q) { return std::abs(q.norm() - 1.0) <= 1e-3; }

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

bool fits(const Instrument& i) { return isInstrumentNumber(static_cast<unsigned>(i.kind)); }

}  // namespace

bool isValid(const Tick& tick) {
  const bool hands = std::all_of(tick.samples.hand.begin(), tick.samples.hand.end(), [](const InstrumentSample& hand) {
    return hand.position.allFinite() && isRotation(hand.orientation) && std::isfinite(hand.jaw) &&
           isInstrumentNumber(static_cast<unsigned>(hand.instrument));
  });
  const CameraSample& camera = tick.samples.camera;
  return hands && camera.position.allFinite() && isRotation(camera.orientation) && std::isfinite(tick.logged.lateness);
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
  for (const ClipView& clip : view.clip) out.clip.push_back({clip});
  for (std::size_t h = 0; h < handCount; ++h) out.instrument[h] = {view.instrument[h]};
  out.camera = view.camera;
  out.fieldOfView = view.verticalFieldOfView;
  return out;
}

bool fromWire(View view, SceneView& out) {
  const auto fitsAll = [](const auto& parts) {
    return std::all_of(parts.begin(), parts.end(), [](const auto& part) { return fits(part); });
  };
  if (!fitsAll(view.surface) || !fitsAll(view.bed) || !fitsAll(view.instrument)) return false;
  out = {};
  out.step = view.step;
  out.time = view.time;
  out.surface.assign(std::make_move_iterator(view.surface.begin()), std::make_move_iterator(view.surface.end()));
  out.connective.assign(std::make_move_iterator(view.bed.begin()), std::make_move_iterator(view.bed.end()));
  out.clip.assign(view.clip.begin(), view.clip.end());
  std::copy(view.instrument.begin(), view.instrument.end(), out.instrument.begin());
  out.camera = view.camera;
  out.verticalFieldOfView = view.fieldOfView;
  return true;
}

}  // namespace calot::recorder::wire
