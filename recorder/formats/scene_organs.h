// SPDX-License-Identifier: GPL-3.0-or-later
// The organs of a scene file. Internal to this folder.
#pragma once

#include <vector>

#include "recorder/base/json_reader.h"
#include "recorder/formats/scene_surface.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// One organ with its surface. @throws Error damaged, naming the place or the mesh.
OrganDescription readOrgan(const JsonPlace& place, const FetchAsset& fetch);

/// Do the organs' names differ, and does every anchor name another organ of the scene? @throws Error damaged.
void checkOrgans(const JsonPlace& place, const std::vector<OrganDescription>& organs);

}  // namespace calot::recorder
