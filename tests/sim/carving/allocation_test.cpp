// SPDX-License-Identifier: GPL-3.0-or-later
// The carve path does not allocate once it has its room.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "sim/carving/carved_field.h"
#include "tests/sim/carving/support/carving_bodies.h"

namespace {
std::size_t allocations = 0;
}  // namespace

// Counts for the whole program; what it gives is what it always gave.
void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  ++allocations;
  return std::malloc(size);
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t /*size*/) noexcept { std::free(p); }

namespace calot {
namespace {

TEST(Allocation, NoStrokeAllocates) {
  const FieldModel model = test::lump(65);
  CarvedField field(model);
  CarvedBricks state;
  field.reserve(state);
  Islands islands(model.lattice, test::floorAnchors(model.lattice));
  islands.rebuild(field);
  CarvedSurface surface(model.lattice);
  surface.rebuild(field);
  Fill fill(model.lattice, 4);
  fill.rebuild(field);
  const UndeformedTissue tissue(model.lattice);
  const double depth = carveDepth * model.lattice.cell();
  Random random(8, 8);
  const Box box{{-0.02, -0.015, -0.005}, {0.02, 0.015, 0.008}};
  const std::size_t before = allocations;
  std::int64_t removed = 0;
  for (int i = 0; i < 150; ++i) {
    const SweptCapsule tool[1] = {test::randomSweep(random, box, 0.0015, 0.004, 0.002)};
    const NodeBox boxes[1] = {nodesWithin(model.lattice, sweptBounds(tool, depth, 1.0))};
    field.begin();
    carve(field, tool, boxes, tissue, depth);
    removed += islands.remove(field);
    field.commit(state);
    surface.update(field);
    fill.update(field);
  }
  EXPECT_EQ(allocations - before, 0U);
  EXPECT_EQ(surface.growths(), 0U);
  EXPECT_GT(removed, 0);
  EXPECT_GT(before, 0U);
}

}  // namespace
}  // namespace calot
