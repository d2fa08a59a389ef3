// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/performer.h"

#include "recorder/sources/operation_source.h"
#include "recorder/sources/performer_source.h"

namespace calot::recorder {

std::unique_ptr<SampleSource> makePerformer(const PerformerProfile& profile, const SceneDescription& scene,
                                            std::uint64_t seed) {
  if (scene.connective.empty() && scene.vessels.empty() && scene.fat.empty()) {
    return std::make_unique<PerformerSource>(profile, scene, seed);
  }
  return std::make_unique<OperationSource>(profile, scene, seed);
}

}  // namespace calot::recorder
