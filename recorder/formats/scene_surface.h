// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that a scene file names.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/base/json_reader.h"
#include "recorder/formats/surface_bytes.h"
#include "sim/tissue/structure.h"

namespace calot::recorder {

/// Gives the asset of a name, or fails at the place that names it.
using FetchAsset = std::function<const Asset&(const std::string& name, const JsonPlace& place)>;

/// A "mesh" of a scene file: a surface's file, and where the surface is placed in W.
struct MeshFile {
  std::string file;
  LengthUnit unit = LengthUnit::metre;
  double scale = 1.0;
  Vec3 rotation = Vec3::Zero();     ///< rotation vector (rad)
  Vec3 translation = Vec3::Zero();  ///< m

  static std::vector<Field> fields();
};

/// An organ's surface: closed and outward as it is, and of an organ's size. Empty where the place has noted faults.
/// @throws Error (damaged), naming the place or the file
SurfaceDescription readOrganSurface(const JsonPlace& mesh, const FetchAsset& fetch);

/// Fat's surface. Repairs that invent no surface (repairSurface) are made and reported in a warning. Self-intersection
/// is a warning as well: the inside is then what the surface winds around (the potential field's rule). A surface with
/// holes or with edges of more than two triangles is refused, and so is a self-intersecting one whose triangles had to
/// be reversed, since nothing then defines its inside.
/// @param[in,out] warnings one line each, naming the file, are added
/// @throws Error (damaged), naming the place or the file
SurfaceDescription readFatSurface(const JsonPlace& mesh, const FetchAsset& fetch, std::vector<std::string>& warnings);

}  // namespace calot::recorder
