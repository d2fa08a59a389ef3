// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies, strokes and judges for the tests of carving.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "sim/carving/carved_field.h"
#include "sim/carving/carved_surface.h"
#include "sim/geometry/triangle_mesh.h"
#include "sim/math/random.h"

namespace calot::test {

/// A field from a distance function (m), outside on the border.
FieldModel fieldOf(const BrickLattice& lattice, double bandCells, const std::function<double(const Vec3&)>& distance);

/// The slab of 40 x 30 x 16 mm on which carving of a field is held against removal of tetrahedra.
/// @return distance along the axis on which p is farthest out, negative inside (m)
double slabDistance(const Vec3& p);
bool insideSlab(const Vec3& p);
/// A stroke of 1.5 mm radius somewhere in its upper three quarters.
std::vector<SweptCapsule> slabStroke(Random& random);

/// A lump of fat: a slab of 40 x 30 x 16 mm with waves, in a lattice of nodes^3 over 48 mm.
FieldModel lump(int nodes, double bandCells = 3.0);

/// Values drawn at random at each node, of both signs: no field is worse.
FieldModel noise(Random& random, int nodes);

/// Nodes in the lowest fifth of the lattice along z.
std::vector<std::uint32_t> floorAnchors(const BrickLattice& lattice);

/// A capsule of radius r that sweeps by `length` anywhere in the box, turning as it goes.
SweptCapsule randomSweep(Random& random, const Box& box, double radius, double segment, double length);

/// Carves with tissue at rest, within begin() and commit() (the caller's).
void carveAtRest(CarvedField& field, const std::vector<SweptCapsule>& tool);

/// The whole surface as a mesh; vertices are welded by their names.
TriangleMesh meshOf(const CarvedField& field, const CarvedSurface& surface);

struct EdgeFaults {
  int boundary = 0;     ///< edges with one triangle
  int nonManifold = 0;  ///< with more than two, or two that disagree on outside
  int dangling = 0;     ///< triangles with no neighbour, or with one alone
};
EdgeFaults edgeFaults(const TriangleMesh& mesh);

/// Node by node, without bricks: inside nodes that hang together with an anchor. 1 for each such node of the lattice.
std::vector<std::uint8_t> fullFlood(const CarvedField& field, const std::vector<std::uint32_t>& anchors);

/// Inside nodes of the whole field.
std::int64_t insideNodes(const CarvedField& field);

/// Calls visit(patch) for each patch, in order of keys.
template <class Visit>
void forEachPatch(const CarvedSurface& surface, Visit&& visit) {
  for (const std::uint32_t brick : surface.bricks()) {
    for (std::uint32_t block = 8 * brick; block < 8 * brick + 8; ++block) surface.forEachPatchOfBlock(block, visit);
  }
}

/// Are all patches of both the same, byte for byte?
bool samePatches(const CarvedSurface& x, const CarvedSurface& y);

}  // namespace calot::test
