// SPDX-License-Identifier: GPL-3.0-or-later
// Identity and header of a new attempt.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "sim/scene/model.h"

namespace calot::recorder {

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
