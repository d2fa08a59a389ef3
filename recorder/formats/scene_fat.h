// SPDX-License-Identifier: GPL-3.0-or-later
// The fat of a scene file. Internal to this folder.
#pragma once

#include <string>
#include <vector>

#include "recorder/formats/json_reader.h"
#include "recorder/formats/scene_surface.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// Reads the list. Names differ from each other and from those of the scene's organs and vessels; what it hangs on is
/// an organ or a vessel of the scene, each once.
///
/// The surface. What can be put right without inventing surface is (repairSurface) and is told in a warning. Where it
/// passes through itself, that is a warning too: inside is then what the surface winds around (the potential field's
/// rule). A surface with holes or with edges of more than two triangles is refused, and one that passes through itself
/// and had to be turned: there is then nothing that tells inside from outside.
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
