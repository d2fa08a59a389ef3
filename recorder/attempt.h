// SPDX-License-Identifier: GPL-3.0-or-later
// What a new attempt is called and says of itself.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "sim/scene/model.h"

namespace calot::recorder {

/// What the caller knows of an attempt that the source and the scene do not.
struct AttemptSettings {
  std::string participant;
  std::string station;
  std::string purpose = "training";
  std::string handedness = "unknown";
  Mode mode = Mode::practice;
  std::uint64_t seed = 0;
};

/// Random uuid (RFC 4122, version 4), lower case with hyphens.
std::string newUuid();

/// Header of a new attempt: a fresh uuid, the present time, this build.
AttemptHeader makeHeader(const Model& model, std::vector<Asset> assets, const Provenance& provenance,
                         const AttemptSettings& settings);

/// "calot 0.1.0".
std::string softwareName();
/// Compiler, build type and revision.
std::string buildName();

}  // namespace calot::recorder
