// SPDX-License-Identifier: GPL-3.0-or-later
// A scene from the bytes of its file and of the surfaces that it names; no file is touched. What is in them:
// docs/reference/scenes.md.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/base/json_reader.h"
#include "recorder/formats/surface_bytes.h"
#include "sim/geometry/surface_report.h"
#include "sim/math/linear.h"
#include "sim/scene/description.h"
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
/// @param[in,out] warnings one line each, naming the file, are added
/// @throws Error (damaged), naming the place or the file
SurfaceDescription readOrganSurface(const JsonPlace& mesh, const FetchAsset& fetch, std::vector<std::string>& warnings);

/// Repairs of a surface, or empty: "12 vertices welded, 3 triangles turned".
std::string repairSummary(const SurfaceRepair& repair);

/// Fat's surface. Repairs that invent no surface (repairSurface) are made and reported in a warning. Self-intersection
/// is a warning as well: the inside is then what the surface winds around (the potential field's rule). A surface with
/// holes or with edges of more than two triangles is refused, and so is a self-intersecting one whose triangles had to
/// be reversed, since nothing then defines its inside.
/// @param[in,out] warnings one line each, naming the file, are added
/// @throws Error (damaged), naming the place or the file
SurfaceDescription readFatSurface(const JsonPlace& mesh, const FetchAsset& fetch, std::vector<std::string>& warnings);

struct LoadedScene {
  SceneDescription description;       ///< what a Model is built from
  std::string summary;                ///< one sentence for people
  std::vector<std::string> warnings;  ///< repairs of surfaces, one line each
  std::vector<Asset>
      assets;  ///< the scene file first, then each mesh in the order of the organs and the fat; bytes as read
};

/// Reads a scene's description and its surfaces. @param fetch gives what it names @throws Error (damaged), naming file
/// and JSON pointer, where anything is unknown, missing or out of its range
LoadedScene parseScene(const Asset& file, const FetchAsset& fetch);

/// The same of a recording's assets: the first one is the scene file, the others are looked up by name.
/// @throws Error (damaged) as parseScene, and where a named asset is missing, double, or named by nobody.
LoadedScene sceneFromAssets(std::vector<Asset> assets);

/// Direction of gravity in a scene file that another version's engine reads: its key "gravity" alone is read.
/// @return unit; SceneView's default where the file has none
[[nodiscard]] Vec3 downOf(const Asset& sceneFile);

/// Checks a scene whose fields and surfaces were read, and completes what other fields decide: the camera's
/// orientation, and roles. Rules over fields that have faults are skipped.
/// @param root the scene file
/// @throws Error (damaged), naming the place
void applySceneRules(const JsonPlace& root, SceneDescription& scene);

/// Gives roles to the tissue of a scene that states none, as recordings made before scenes had roles: liver and
/// gallbladder by appearance; a vessel grown to a gallbladder is the cystic duct or, where it does not look like a
/// duct, the cystic artery; other vessels are bile ducts or arteries by appearance; connective tissue on a gallbladder
/// is the cystic plate, and all fat is that of Calot's triangle. Nowhere else is appearance more than a look.
void deriveRoles(SceneDescription& scene);

}  // namespace calot::recorder
