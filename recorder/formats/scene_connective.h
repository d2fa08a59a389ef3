// SPDX-License-Identifier: GPL-3.0-or-later
// The connective tissues of a scene file. Internal to this folder.
#pragma once

#include <vector>

#include "recorder/base/json_reader.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// Reads the list; names differ, and each joins two different organs of the scene.
/// @throws Error damaged, naming the place.
std::vector<ConnectiveDescription> readConnective(const JsonPlace& place, const std::vector<OrganDescription>& organs);

}  // namespace calot::recorder
