// SPDX-License-Identifier: GPL-3.0-or-later
// A stroke and what follows from it allocate nothing once they have their room.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "tests/sim/fat/support/fat_bodies.h"

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

TEST(FatAllocation, NoStrokeAllocates) {
  const auto model =
      test::fatOn(test::lumpSurface({0.012, 0.010, 0.006}), test::fatSettings(0.00075), {test::floorPartner(-0.003)});
  FatBody body(*model);
  FatState state = restState(*model);
  std::vector<Vec3> skin;
  Random random(8, 8);
  const Box box{{-0.01, -0.008, 0.0}, {0.01, 0.008, 0.006}};
  std::size_t before = 0;
  int changed = 0;
  for (int i = 0; i < 101; ++i) {
    if (i == 1) before = allocations;  // the first stroke gives State its room
    const SweptCapsule tool[1] = {test::randomSweep(random, box, 0.0012, 0.003, 0.002)};
    body.beginStep(state);
    changed += body.stroke(state, tool).changed ? 1 : 0;
    body.contact().positions(state.solid.position, skin);
  }
  EXPECT_EQ(allocations - before, 0U);
  EXPECT_EQ(body.growths(), 0U);
  EXPECT_GT(changed, 50);
  EXPECT_GT(before, 0U);
}

TEST(FatAllocation, NoTearAllocates) {
  const auto model =
      test::fatOn(test::lumpSurface({0.012, 0.010, 0.006}), test::fatSettings(0.00075), {test::floorPartner(-0.003)});
  FatBody body(*model);
  FatState state = restState(*model);
  const std::vector<std::uint32_t> thing(model->allTies().size(), 0);
  std::size_t before = 0;
  int torn = 0;
  for (Vec3& p : state.solid.position) p[0] *= 3.5;  // a cube a step
  for (int i = 0; i < 31; ++i) {
    if (i == 1) before = allocations;
    torn += body.tear(state).changed ? 1 : 0;
    EXPECT_FALSE(body.joins(thing, 2)) << "all of it hangs on one thing";
  }
  EXPECT_EQ(allocations - before, 0U);
  EXPECT_EQ(torn, 31);
}

}  // namespace
}  // namespace calot
