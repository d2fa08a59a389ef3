// SPDX-License-Identifier: GPL-3.0-or-later
// The fat of a scene file. Internal to this folder.
#pragma once

#include <string>
#include <vector>

#include "recorder/base/json_reader.h"
#include "recorder/formats/scene_surface.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// Reads the list. Names differ from each other and from those of the scene's organs and vessels; what it hangs on is
/// an organ or a vessel of the scene, each once.
///
/// The surface. Repairs that invent no surface (repairSurface) are made and reported in a warning. Self-intersection is
/// a warning as well: the inside is then what the surface winds around (the potential field's rule). A surface with
/// holes or with edges of more than two triangles is refused, and so is a self-intersecting one whose triangles had to
/// be reversed, since nothing then defines its inside.
///
/// The cells. At least four along each side of the surface's box, and no more than a potential field holds (and at most
/// 16 million in all).
///
/// @param[in,out] warnings one line each, naming the file, are added
/// @throws Error damaged, naming the place or the file
std::vector<FatDescription> readFat(const JsonPlace& place, const std::vector<OrganDescription>& organs,
                                    const std::vector<VesselDescription>& vessels, const FetchAsset& fetch,
                                    std::vector<std::string>& warnings);

}  // namespace calot::recorder
