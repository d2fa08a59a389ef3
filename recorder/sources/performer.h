// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>

#include "recorder/sources/performer_profile.h"
#include "recorder/sources/source.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// The performer for a scene's task: closed loop (OperationSource) if there is something to clear, divide or free; else
/// one that touches the organs (PerformerSource).
/// @throws Error (usage) where the scene offers a hand nothing to do.
std::unique_ptr<SampleSource> makePerformer(const PerformerProfile& profile, const SceneDescription& scene,
                                            std::uint64_t seed);

}  // namespace calot::recorder
