// SPDX-License-Identifier: GPL-3.0-or-later
// Scene keys "procedure", "retraction", "clip" and "cautery". Internal to this folder.
#pragma once

#include <vector>

#include "recorder/base/json_reader.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// @throws Error naming the place where a name is not the scene's, or a vessel is to be both divided and spared
ProcedureDescription readProcedure(const JsonPlace& place, const SceneDescription& scene);

std::vector<RetractionDescription> readRetractions(const JsonPlace& place, const std::vector<OrganDescription>& organs);

ClipDescription readClip(const JsonPlace& place);

CauteryDescription readCautery(const JsonPlace& place);

}  // namespace calot::recorder
