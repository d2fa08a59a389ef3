// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces and materials that a scene file names. Internal to this folder.
#pragma once

#include <functional>
#include <string>

#include "recorder/base/identity.h"
#include "recorder/base/json_reader.h"
#include "sim/geometry/triangle_mesh.h"
#include "sim/scene/description.h"
#include "sim/tissue/structure_role.h"

namespace calot::recorder {

/// Gives the asset of a name, or fails at the place that names it.
using FetchAsset = std::function<const Asset&(const std::string& name, const JsonPlace& place)>;

/// A surface as its file has it, and what the file is called in messages.
struct NamedSurface {
  TriangleMesh mesh;  ///< m
  std::string file;
};

/// Reads the surface of a "mesh" object. @throws Error damaged, naming the place or the file.
NamedSurface readMesh(const JsonPlace& place, const FetchAsset& fetch);

/// A surface with an inside, of a size that a body of a scene can have: as it is, where it is closed and outward.
/// @param what "an organ", for messages. @throws Error damaged, naming the file.
SurfaceDescription closedSurface(NamedSurface surface, const char* what);

/// @throws Error damaged, naming the place.
MaterialDescription readMaterial(const JsonPlace& place);

}  // namespace calot::recorder
