// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/broad_phase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "sim/math/random.h"

namespace calot {
namespace {

/// Boxes of all kinds: points, sheets, small, larger than the world, far away, beyond the range of cell numbers.
Box randomBox(Random& random) {
  Vec3 centre;
  Vec3 half;
  const double kind = random.uniform();
  const double spread = kind < 0.9 ? 0.1 : (kind < 0.97 ? 10.0 : 1e6);
  for (int a = 0; a < 3; ++a) {
    centre[a] = spread * random.normal();
    half[a] = 0.04 * random.uniform();
    if (random.uniform() < 0.1) half[a] = 0.0;
    if (random.uniform() < 0.03) half[a] = 1e3;
    // On the borders of cells, where rounding down decides.
    if (random.uniform() < 0.2) centre[a] = 0.02 * static_cast<double>(static_cast<int>(centre[a] / 0.02));
  }
  Box box;
  box.include(centre - half);
  box.include(centre + half);
  return box;
}

TEST(SortedGrid, FindsEveryOverlapSortedAndOnce) {
  SCOPED_TRACE("seed 51");
  Random random(51);
  SortedGrid grid(0.02);  // one for all: an update forgets what was before
  std::vector<BroadPhase::Pair> found{{7, 7}};
  std::size_t overlaps = 0;
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<Box> leaves(trial == 0 ? 0 : 1 + random.next() % 300);
    std::vector<Box> queries(random.next() % 30);
    for (Box& box : leaves) box = randomBox(random);
    for (Box& box : queries) box = randomBox(random);
    grid.update(leaves);
    grid.pairs(queries, found);
    ASSERT_TRUE(std::is_sorted(found.begin(), found.end()));
    ASSERT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
    for (const BroadPhase::Pair& p : found) {
      ASSERT_LT(p.query, queries.size());
      ASSERT_LT(p.leaf, leaves.size());
    }
    for (std::uint32_t q = 0; q < queries.size(); ++q) {
      for (std::uint32_t l = 0; l < leaves.size(); ++l) {
        if (!queries[q].overlaps(leaves[l])) continue;
        ++overlaps;
        ASSERT_TRUE(std::binary_search(found.begin(), found.end(), BroadPhase::Pair{q, l}))
            << "trial " << trial << " query " << q << " leaf " << l;
      }
    }
  }
  EXPECT_GT(overlaps, 500U) << "too few overlaps to tell anything";
}

TEST(SortedGrid, BoxesThatOnlyTouchOverlap) {
  Box leaf;
  leaf.include(Vec3(-0.02, -0.02, -0.02));
  leaf.include(Vec3::Zero());
  Box query;
  query.include(Vec3::Zero());
  SortedGrid grid(0.02);
  grid.update({&leaf, 1});
  std::vector<BroadPhase::Pair> found;
  grid.pairs({&query, 1}, found);
  EXPECT_EQ(found.size(), 1U);
}

}  // namespace
}  // namespace calot
