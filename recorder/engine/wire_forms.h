// SPDX-License-Identifier: GPL-3.0-or-later
// Samples, events, keyframes and scene views in the protocol's form, and back.
#pragma once

#include <span>
#include <vector>

#include "recorder/engine/observer.h"
#include "recorder/engine/wire.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/step_result.h"

namespace calot::recorder::wire {

/// @param logged names contact sets, and says how late the tick ran
Tick toWire(const TickSamples& samples, const TickOutcome& logged);
/// @return false where something in it is no number, no rotation or no instrument that there is
bool fromWire(const Tick& tick, TickSamples& samples, TickOutcome& logged);
/// The ticks of a step's request, into memory that is used again. @pre as many outcomes as samples
void toWire(std::span<const TickSamples> samples, std::span<const TickOutcome> logged, std::vector<Tick>& out);

Event toWire(const calot::Event& event);
calot::Event fromWire(const Event& event);

inline Keyframe toWire(const recorder::Keyframe& keyframe) { return {keyframe.step, keyframe.state, keyframe.haptics}; }
inline recorder::Keyframe fromWire(Keyframe keyframe) {
  return {keyframe.step, std::move(keyframe.state), std::move(keyframe.haptics)};
}

View toWire(const SceneView& view);
/// @return false where its lists do not fit one another
bool fromWire(View view, SceneView& out);

}  // namespace calot::recorder::wire
