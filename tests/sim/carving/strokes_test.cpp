// SPDX-License-Identifier: GPL-3.0-or-later
// Harsh random strokes: after every one, what was updated locally is what a full pass gives, bit for bit, and the
// surface has no fault.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "sim/carving/carved_field.h"
#include "sim/carving/carved_surface.h"
#include "tests/sim/carving/support/carving_bodies.h"

namespace calot {
namespace {

/// One body and everything that is kept in step with it, and a second set for full passes.
struct Bench {
  FieldModel model;
  std::vector<std::uint32_t> anchors;
  CarvedField field;
  CarvedBricks state;
  Islands islands;
  CarvedSurface surface;
  CarvedSurface fresh;
  AdaptiveSurface adaptive;
  AdaptiveSurface freshAdaptive;
  Fill fill;
  Fill freshFill;

  explicit Bench(FieldModel m)
      : model(std::move(m)),
        anchors(test::floorAnchors(model.lattice)),
        field(model),
        islands(model.lattice, anchors),
        surface(model.lattice),
        fresh(model.lattice),
        adaptive(model.lattice),
        freshAdaptive(model.lattice),
        fill(model.lattice, 4),
        freshFill(model.lattice, 4) {
    field.reserve(state);
    islands.rebuild(field);
    field.begin();
    islands.remove(field);
    field.commit(state);
    surface.rebuild(field);
    adaptive.rebuild(field);
    fill.rebuild(field);
  }

  std::int64_t stroke(const std::vector<SweptCapsule>& tool) {
    field.begin();
    test::carveAtRest(field, tool);
    const std::int64_t removed = islands.remove(field);
    field.commit(state);
    surface.update(field);
    adaptive.update(field);
    fill.update(field);
    return removed;
  }

  void expectEqualToFullPasses() {
    // State alone gives the same field back.
    CarvedField again(model);
    ASSERT_TRUE(again.restore(state));
    ASSERT_EQ(again.values(), field.values());
    // Islands: nothing is inside but what a flood from the anchors reaches.
    const std::vector<std::uint8_t> held = test::fullFlood(field, anchors);
    for (std::uint32_t n = 0; n < held.size(); ++n) ASSERT_EQ(held[n] != 0, field.inside(n)) << n;
    fresh.rebuild(field);
    ASSERT_TRUE(test::samePatches(surface, fresh));
    freshAdaptive.rebuild(field);
    ASSERT_TRUE(adaptive == freshAdaptive);
    freshFill.rebuild(field);
    ASSERT_TRUE(std::equal(fill.counts().begin(), fill.counts().end(), freshFill.counts().begin()));
  }
};

void expectNoFault(const TriangleMesh& mesh) {
  const test::EdgeFaults faults = test::edgeFaults(mesh);
  ASSERT_EQ(faults.boundary, 0);
  ASSERT_EQ(faults.nonManifold, 0);
  ASSERT_EQ(faults.dangling, 0);
}

void harshStrokes(int count, std::uint64_t seed, int nodes) {
  Random random(seed, 5);
  std::cout << "seed " << seed << "\n";
  auto bench = std::make_unique<Bench>(test::lump(nodes));
  std::int64_t islands = 0;
  std::size_t bodies = 1;
  std::size_t fine = 0;
  std::size_t coarse = 0;
  const Box box{{-0.021, -0.016, -0.008}, {0.021, 0.016, 0.009}};
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    std::vector<SweptCapsule> tool;
    const int pieces = 1 + static_cast<int>(random.next() % 3);
    for (int k = 0; k < pieces; ++k) {
      const double radius = random.uniform(0.0003, 0.002);
      const double segment = random.uniform() < 0.2 ? 0.0 : random.uniform(0.0, 0.012);
      const double length = random.uniform() < 0.2 ? 0.0 : random.uniform(0.0, 0.008);
      tool.push_back(test::randomSweep(random, box, radius, segment, length));
    }
    islands += bench->stroke(tool);
    fine += bench->surface.triangles();
    coarse += bench->adaptive.triangles();
    ASSERT_NO_FATAL_FAILURE(bench->expectEqualToFullPasses());
    ASSERT_NO_FATAL_FAILURE(expectNoFault(test::meshOf(bench->field, bench->surface)));
    ASSERT_NO_FATAL_FAILURE(expectNoFault(bench->adaptive.mesh()));
    if (test::insideNodes(bench->field) < 500) {
      bench = std::make_unique<Bench>(test::lump(nodes));
      ++bodies;
    }
  }
  std::cout << count << " strokes on " << bodies << " bodies, " << islands << " nodes of islands; adaptive triangles "
            << 100.0 * static_cast<double>(coarse) / static_cast<double>(fine) << " % of the fast surface's\n";
  EXPECT_GT(islands, 0);
}

TEST(Strokes, LocalIsFullAndFaultless) { harshStrokes(2000, 1, 41); }

TEST(StrokesHeavy, LocalIsFullAndFaultless) {
  if (std::getenv("CALOT_HEAVY") == nullptr) GTEST_SKIP() << "CALOT_HEAVY=1 runs 100,000 strokes";
  for (std::uint64_t seed = 2; seed < 52; ++seed) ASSERT_NO_FATAL_FAILURE(harshStrokes(2000, seed, 41));
}

TEST(Strokes, NoiseHasNoFault) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed, 6);
    const FieldModel model = test::noise(random, 5 + static_cast<int>(seed % 14));
    ASSERT_EQ(model.fault(), "");
    const CarvedField field(model);
    CarvedSurface surface(model.lattice);
    surface.rebuild(field);
    const TriangleMesh mesh = test::meshOf(field, surface);
    EXPECT_GT(mesh.triangles(), 20);
    expectNoFault(mesh);
    // One fan around each vertex: as many triangles as sides at it, in one cycle.
    AdaptiveSurface adaptive(model.lattice);
    adaptive.rebuild(field);
    expectNoFault(adaptive.mesh());
  }
}

}  // namespace
}  // namespace calot
