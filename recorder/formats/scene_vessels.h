// SPDX-License-Identifier: GPL-3.0-or-later
// The ducts and arteries of a scene file. Internal to this folder.
#pragma once

#include <vector>

#include "recorder/base/json_reader.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// Reads the list. Names differ from each other and from the organs'; the wall is thinner than the radius; neighbouring
/// points of a path are apart and the path does not fold back; an end that is grown to an organ or out of an earlier
/// vessel is near it. @throws Error damaged, naming the place.
std::vector<VesselDescription> readVessels(const JsonPlace& place, const std::vector<OrganDescription>& organs);

}  // namespace calot::recorder
