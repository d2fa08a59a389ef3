// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>

#include "recorder/recording/reader.h"
#include "recorder/replay.h"

namespace calot::recorder {

/// The first difference of a re-simulated tick's forces, bit for bit.
std::optional<Divergence> compareTick(std::uint64_t step, std::uint64_t tick, const TickOutcome& recorded,
                                      const TickOutcome& here);

/// The first differing component of the State digests and its first differing field.
std::optional<Divergence> compareDigest(std::uint64_t step, const DigestLayout& layout, const StateDigest& recorded,
                                        const StateDigest& here);

/// The first difference of observables and events.
std::optional<Divergence> compareResult(const StepResult& recorded, const StepResult& here);

/// The first difference of two keyframes' States, or of their haptic bytes.
std::optional<Divergence> compareKeyframe(const Model& model, const Keyframe& recorded, const Keyframe& here);

}  // namespace calot::recorder
