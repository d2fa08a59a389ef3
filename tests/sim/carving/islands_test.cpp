// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/carving/carved_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "tests/sim/carving/support/carving_bodies.h"

namespace calot {
namespace {

TEST(Islands, EqualAFloodOnNoise) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed, 8);
    const FieldModel model = test::noise(random, 20 + static_cast<int>(seed % 9));
    std::vector<std::uint32_t> anchors;
    for (int i = 0; i < 5; ++i) anchors.push_back(random.next() % static_cast<std::uint32_t>(model.lattice.storage()));
    CarvedField field(model);
    const std::vector<std::uint8_t> held = test::fullFlood(field, anchors);
    const std::int64_t before = test::insideNodes(field);
    Islands islands(model.lattice, anchors);
    islands.rebuild(field);
    field.begin();
    const std::int64_t removed = islands.remove(field);
    EXPECT_EQ(removed, before - test::insideNodes(field));
    for (std::uint32_t n = 0; n < held.size(); ++n) ASSERT_EQ(held[n] != 0, field.inside(n)) << n;
    // Again there is nothing to do, and no search is asked for.
    CarvedBricks state;
    field.commit(state);
    field.begin();
    EXPECT_EQ(islands.remove(field), 0);
    EXPECT_TRUE(field.changed().empty());
  }
}

TEST(Islands, CheckerboardHasTheMostComponents) {
  const BrickLattice lattice(Vec3::Zero(), 1.0, Index3::Constant(18));
  const FieldModel model =
      test::fieldOf(lattice, 1.0, [](const Vec3& p) { return static_cast<int>(p.sum()) % 2 == 0 ? -0.5 : 0.5; });
  CarvedField field(model);
  const std::int64_t before = test::insideNodes(field);
  EXPECT_EQ(before, 2048);
  Islands islands(lattice, std::vector<std::uint32_t>{lattice.node({2, 2, 2}), lattice.node({9, 9, 10})});
  islands.rebuild(field);
  field.begin();
  EXPECT_EQ(islands.remove(field), before - 2);
  EXPECT_TRUE(field.inside(lattice.node({2, 2, 2})));
  EXPECT_TRUE(field.inside(lattice.node({9, 9, 10})));
}

TEST(Islands, ACutOffPartLeaves) {
  const FieldModel model = test::lump(41);
  std::vector<std::uint32_t> anchors;
  for (const std::uint32_t n : test::floorAnchors(model.lattice)) {
    if (model.lattice.position(model.lattice.nodeAt(n))[0] < -0.01) anchors.push_back(n);
  }
  CarvedField field(model);
  CarvedBricks state;
  Islands islands(model.lattice, anchors);
  islands.rebuild(field);
  std::int64_t removed = 0;
  for (int i = 0; i < 14; ++i) {  // across, 3 mm wide, from one side to the other
    field.begin();
    const double y = -0.018 + 0.0026 * i;
    const Vec3 low(0.002, y, -0.012);
    const Vec3 high(0.002, y, 0.012);
    const Vec3 on(0.0, 0.0026, 0.0);
    test::carveAtRest(field, {{low, high, low + on, high + on, 0.0015}});
    const std::int64_t now = islands.remove(field);
    EXPECT_TRUE(now == 0 || removed == 0);
    removed += now;
    field.commit(state);
  }
  EXPECT_GT(removed, 1000);
  for (std::uint32_t n = 0; n < model.lattice.storage(); ++n) {
    if (!field.inside(n)) continue;
    ASSERT_LT(model.lattice.position(model.lattice.nodeAt(n))[0], 0.001);
  }
  std::cout << removed << " nodes left with the part\n";
}

/// Two blocks, and a bridge between them where there is one.
FieldModel blocks(bool bridge) {
  const BrickLattice lattice(Vec3::Zero(), 1.0, Index3::Constant(26));
  return test::fieldOf(lattice, 3.0, [bridge](const Vec3& p) {
    const auto box = [&p](const Vec3& lower, const Vec3& upper) {
      return std::max((lower - p).maxCoeff(), (p - upper).maxCoeff());
    };
    const double ends = std::min(box({2.5, 2.5, 2.5}, {8.5, 22.5, 22.5}), box({16.5, 2.5, 2.5}, {22.5, 22.5, 22.5}));
    return bridge ? std::min(ends, box({8.0, 11.5, 11.5}, {17.0, 12.5, 12.5})) : ends;
  });
}

TEST(Islands, ConnectWhatHangsOnTheSamePart) {
  constexpr std::uint32_t left = 0, right = 1, loose = 2, beside = 3, things = 4;
  const auto node = [](const FieldModel& model, int x) { return model.lattice.node({x, 12, 12}); };
  const auto hangEnds = [&](Islands& islands, const CarvedField& field, const FieldModel& model) {
    islands.connect(field, things);
    islands.hang(left, node(model, 4));
    islands.hang(right, node(model, 20));
  };
  const FieldModel whole = blocks(true);
  const std::vector<std::uint32_t> anchors{node(whole, 4), node(whole, 20)};
  CarvedField field(whole);
  Islands islands(whole.lattice, anchors);
  islands.rebuild(field);
  hangEnds(islands, field, whole);
  EXPECT_TRUE(islands.connected(left, right)) << "by a bridge of one node";
  EXPECT_FALSE(islands.connected(left, loose));

  CarvedBricks state;
  field.begin();
  BrickBits cut{};
  const std::uint32_t middle = node(whole, 12);
  cut[middle >> 6U & 7U] = std::uint64_t{1} << (middle & 63U);
  field.remove(middle / BrickLattice::brickNodes, cut);
  EXPECT_EQ(islands.remove(field), 0) << "both halves are anchored";
  field.commit(state);
  hangEnds(islands, field, whole);
  EXPECT_FALSE(islands.connected(left, right)) << "the bridge is cut";
  // A thing that hangs on both leads over.
  islands.hang(loose, node(whole, 5));
  EXPECT_FALSE(islands.connected(left, right));
  islands.hang(loose, node(whole, 19));
  EXPECT_TRUE(islands.connected(left, right));
  EXPECT_FALSE(islands.connected(left, beside)) << "it hangs on nothing";

  // As after a restore.
  Islands anew(whole.lattice, anchors);
  anew.rebuild(field);
  hangEnds(anew, field, whole);
  EXPECT_FALSE(anew.connected(left, right));

  const FieldModel apart = blocks(false);
  CarvedField two(apart);
  Islands islandsOfTwo(apart.lattice, anchors);
  islandsOfTwo.rebuild(two);
  hangEnds(islandsOfTwo, two, apart);
  EXPECT_FALSE(islandsOfTwo.connected(left, right));
}

}  // namespace
}  // namespace calot
