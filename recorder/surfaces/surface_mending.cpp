// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/surfaces/surface_mending.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "recorder/formats/surface_bytes.h"
#include "recorder/surfaces/surface_parts.h"
#include "recorder/surfaces/surface_stitching.h"

namespace calot::recorder {
namespace {

/// The same parts, mended once more, keep what the file says of them.
void remember(const std::vector<SurfacePart>& before, std::vector<SurfacePart>& now) {
  if (before.size() != now.size()) return;
  for (std::size_t i = 0; i < now.size(); ++i) {
    now[i].inward = before[i].inward;
    now[i].turned = now[i].turned == 0 ? before[i].turned : now[i].mesh.triangles() - before[i].turned;
  }
}

}  // namespace

MendedSurface mendSurface(const TriangleMesh& read, bool fill) {
  MendedSurface made;
  TriangleMesh mesh = read;
  made.repair.droppedVertices = dropUnusedVertices(mesh);
  if (!hasSoundEdges(mesh)) {
    made.repair.weldedVertices = weldVertices(mesh);
    stitchEdges(mesh, made.notes);
  }
  std::vector<SurfacePart> parts = partsOf(mesh, made.repair);
  mesh = joined(parts);
  const auto again = [&](const TriangleMesh& changed) {
    const std::vector<SurfacePart> before = std::exchange(parts, partsOf(changed, made.repair));
    remember(before, parts);
  };
  if (separateParts(mesh, made.notes)) again(mesh);
  if (fill) {
    HoleFilling filling = fillHoles(joined(parts));
    made.holes = std::move(filling.holes);
    // Only of a closed surface is it known what is outside.
    if (!made.holes.empty()) again(filling.mesh);
  } else {
    made.holes = findHoles(joined(parts));
  }
  if (std::all_of(parts.begin(), parts.end(), [](const SurfacePart& p) { return hasSoundEdges(p.mesh); })) {
    arrangeParts(parts, made.notes);
    std::vector<SurfacePart> single;
    std::copy_if(parts.begin(), parts.end(), std::back_inserter(single),
                 [](const SurfacePart& p) { return !p.united; });
    made.crossing = findSelfCrossing(joined(single));
  }
  for (const SurfacePart& part : parts) made.repair.flippedTriangles += part.turned;
  made.mesh = joined(parts);
  return made;
}

}  // namespace calot::recorder
