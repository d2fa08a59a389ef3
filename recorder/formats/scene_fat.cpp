// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_fat.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/formats/mesh_report.h"
#include "recorder/formats/scene_names.h"
#include "recorder/formats/scene_roles.h"
#include "recorder/formats/scene_rules.h"
#include "sim/geometry/brick_lattice.h"
#include "sim/geometry/surface_report.h"

namespace calot::recorder {
namespace {

constexpr std::size_t maxFat = 4;
constexpr double fewestCells = 4.0;                          ///< along a side of the box
constexpr double mostCells = 16e6;                           ///< of the box
constexpr double sideCells = BrickLattice::maxNodes - 16.0;  ///< along a side, with room for a margin

template <class Named>
bool known(const std::vector<Named>& all, const std::string& name) {
  return std::any_of(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
}

SurfaceDescription readFatSurface(const JsonPlace& place, const FetchAsset& fetch, std::vector<std::string>& warnings) {
  NamedSurface surface = readMesh(place, fetch);
  const std::string file = surface.file;
  int turned = 0;
  // A sound surface is not repaired: the repair would treat a part that starts inside another one as a cavity.
  if (const SurfaceReport found = inspectSurface(surface.mesh);
      !found.closedManifold() || found.coincidentVertices + found.degenerateTriangles + found.unusedVertices > 0) {
    SurfaceRepair repair = repairSurface(surface.mesh);
    turned = repair.flippedTriangles;
    if (repair.changed()) warnings.push_back(file + ": put right before use: " + repairSummary(repair));
    surface.mesh = std::move(repair.mesh);
  }
  SurfaceDescription closed = closedSurface(std::move(surface), "fat");
  const SelfCrossing crossing = findSelfCrossing({closed.vertex, closed.triangle});
  if (crossing.pairs > 0) {
    const std::string where = fmt::format("{}: the surface passes through itself, as at ({:.4f}, {:.4f}, {:.4f}) m",
                                          file, crossing.where[0], crossing.where[1], crossing.where[2]);
    if (turned > 0) {
      throw Error(ErrorKind::damaged,
                  where + ", and its triangles do not agree on what is outside: its inside cannot be told");
    }
    warnings.push_back(where + "; what it winds around is taken as its inside");
  }
  return closed;
}

void checkCells(const JsonObject& object, const FatDescription& fat) {
  const Box box = bounds({fat.surface.vertex, fat.surface.triangle});
  const Vec3 cells = (box.upper - box.lower) / fat.cellSize;
  if (cells.minCoeff() >= fewestCells && cells.maxCoeff() <= sideCells && cells.prod() <= mostCells) return;
  object.at("cellSize")
      .fail(fmt::format(
          "the surface's box has {:.0f} x {:.0f} x {:.0f} cells of this size; from {} to {} along each side "
          "and at most {:.0f} in all are allowed",
          cells[0], cells[1], cells[2], fewestCells, sideCells, mostCells));
}

FatAttachmentDescription readAttachment(const JsonPlace& place, const std::vector<OrganDescription>& organs,
                                        const std::vector<VesselDescription>& vessels) {
  const JsonObject object = place.object(sceneRule("fatAttachment"));
  FatAttachmentDescription attachment;
  attachment.to = readName(object, "to");
  if (!known(organs, attachment.to) && !known(vessels, attachment.to)) {
    object.at("to").fail("the scene has no organ and no vessel of this name");
  }
  object.read("distance", attachment.distance);
  object.read("stiffness", attachment.stiffness);
  object.read("damping", attachment.damping);
  return attachment;
}

/// Region to be cleared.
void readTriangle(const JsonPlace& place, FatDescription& fat) {
  const JsonObject object = place.object(sceneRule("fatTriangle"));
  static const KeyRule bounds = sceneCoordinate();
  std::size_t k = 0;
  for (const JsonPlace& corner : object.at("corners").list(3, 3)) fat.triangle[k++] = corner.vector(bounds);
  const Vec3 normal = (fat.triangle[1] - fat.triangle[0]).cross(fat.triangle[2] - fat.triangle[0]);
  if (!(normal.norm() >= 1e-6)) object.at("corners").fail("its corners lie on a line, or nearly");
  object.read("depth", fat.triangleDepth);
}

}  // namespace

std::vector<FatDescription> readFat(const JsonPlace& place, const std::vector<OrganDescription>& organs,
                                    const std::vector<VesselDescription>& vessels, const FetchAsset& fetch,
                                    std::vector<std::string>& warnings) {
  std::vector<FatDescription> all;
  for (const JsonPlace& item : place.list(0, maxFat)) {
    const JsonObject object = item.object(sceneRule("fat"));
    FatDescription fat;
    fat.name = readName(object, "name");
    if (known(organs, fat.name)) object.at("name").fail("an organ has this name");
    if (known(vessels, fat.name)) object.at("name").fail("a vessel has this name");
    if (known(all, fat.name)) object.at("name").fail("other fat has this name");
    fat.appearance = readName(object, "appearance");
    fat.role = readRole(object, {StructureRole::triangleFat});
    object.read("cellSize", fat.cellSize);
    object.read("cellsPerCube", fat.cellsPerCube);
    fat.material = readMaterial(object.at("material"));
    object.read("friction", fat.friction);
    for (const JsonPlace& one : object.at("attachments").list(0, maxStructures)) {
      const FatAttachmentDescription attachment = readAttachment(one, organs, vessels);
      const bool twice = std::any_of(fat.attachments.begin(), fat.attachments.end(),
                                     [&](const FatAttachmentDescription& other) { return other.to == attachment.to; });
      if (twice) one.fail("a second attachment to \"" + attachment.to + "\"");
      fat.attachments.push_back(attachment);
    }
    if (object.has("triangle")) readTriangle(object.at("triangle"), fat);
    fat.surface = readFatSurface(object.at("mesh"), fetch, warnings);
    checkCells(object, fat);
    all.push_back(std::move(fat));
  }
  return all;
}

}  // namespace calot::recorder
