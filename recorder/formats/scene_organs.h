// SPDX-License-Identifier: GPL-3.0-or-later
// The organs of a scene file. Internal to this folder.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "recorder/formats/json_reader.h"
#include "recorder/identity.h"
#include "sim/scene/description.h"

namespace calot::recorder {

inline constexpr std::size_t mostOrgans = 32;  ///< an organ is a bit of HandResult::touching

/// Gives the asset of a name, or fails at the place that names it.
using FetchAsset = std::function<const Asset&(const std::string& name, const JsonPlace& place)>;

/// One organ with its surface. @throws Error damaged, naming the place or the mesh.
OrganDescription readOrgan(const JsonPlace& place, const FetchAsset& fetch);

/// Do the organs' names differ, and does every anchor name another organ of the scene? @throws Error damaged.
void checkOrgans(const JsonPlace& place, const std::vector<OrganDescription>& organs);

}  // namespace calot::recorder
