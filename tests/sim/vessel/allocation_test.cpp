// SPDX-License-Identifier: GPL-3.0-or-later
// A step of a vessel takes nothing from the heap once its working memory has its size.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

#include "sim/vessel/tube_surface.h"
#include "tests/sim/vessel/support/beams.h"

namespace {

std::size_t allocations = 0;

}  // namespace

// The sanitizers bring these themselves: nothing is counted there.
#ifndef CALOT_SANITIZED
void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t /*size*/) noexcept { std::free(p); }
#endif

namespace calot {
namespace {

TEST(BeamSolver, AStepAllocatesNothing) {
  const BeamModel model({test::duct(40, true, true)});
  BeamState state = restState(model);
  BeamSolver solver;
  TubeSurface tube(model, 0, {8, 1});
  std::vector<Vec3> skin;
  std::vector<Vec3> impulse(model.nodes(), Vec3::Zero());
  impulse[20] = Vec3(1e-4, 0.0, 2e-4);
  std::vector<BeamAttachment> attachments{{10, 100.0, 0.1, model.rest()[10], Vec3::Zero()}};
  const std::vector<int> nodes{3, 20, 21, 30};
  BeamLoads loads;
  loads.attachments = attachments;
  const auto step = [&] {
    solver.solveUnconstrained(model, state, loads, 0.01);
    solver.precomputeCompliance(model, nodes);
    solver.applyImpulses(model, impulse);
    solver.advance(model, state);
    tube.update(state);
    tube.positions(state, skin);
  };
  step();
#ifndef CALOT_SANITIZED
  ::operator delete(::operator new(8));
  ASSERT_GT(allocations, 0U) << "the counter counts";
#endif
  const std::size_t before = allocations;
  for (int k = 0; k < 100; ++k) step();
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace calot
