// SPDX-License-Identifier: GPL-3.0-or-later
// What every broad phase promises, as tests to be run over each: shared by those of the core and of sim/bullet.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sim/contact/broad_phase.h"
#include "sim/math/random.h"

namespace calot::test {

/// Boxes of all kinds: points, sheets, small, larger than the world, far away, beyond the range of cell numbers and
/// of float.
inline Box randomBox(Random& random) {
  Vec3 centre;
  Vec3 half;
  const double kind = random.uniform();
  const double spread = kind < 0.9 ? 0.1 : (kind < 0.96 ? 10.0 : (kind < 0.99 ? 1e6 : 1e39));
  for (int a = 0; a < 3; ++a) {
    centre[a] = spread * random.normal();
    half[a] = 0.04 * random.uniform();
    if (random.uniform() < 0.1) half[a] = 0.0;
    if (random.uniform() < 0.03) half[a] = 1e3;
    if (random.uniform() < 0.005) half[a] = 1e40;
    // On the borders of cells, where rounding down decides.
    if (random.uniform() < 0.2 && spread < 1e7) {
      centre[a] = 0.02 * static_cast<double>(static_cast<int>(centre[a] / 0.02));
    }
  }
  Box box;
  box.include(centre - half);
  box.include(centre + half);
  return box;
}

/// Asks for pairs and holds them against all overlaps. @return the number of overlaps
inline std::size_t expectSuperset(const BroadPhase& broad, const std::vector<Box>& leaves,
                                  const std::vector<Box>& queries, const std::string& where) {
  std::vector<BroadPhase::Pair> found{{7, 7}};  // what was there is forgotten
  broad.pairs(queries, found);
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end())) << where;
  EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << where;
  for (const BroadPhase::Pair& p : found) {
    EXPECT_LT(p.query, queries.size()) << where;
    EXPECT_LT(p.leaf, leaves.size()) << where;
  }
  std::size_t overlaps = 0;
  for (std::uint32_t q = 0; q < queries.size(); ++q) {
    for (std::uint32_t l = 0; l < leaves.size(); ++l) {
      if (!queries[q].overlaps(leaves[l])) continue;
      ++overlaps;
      EXPECT_TRUE(std::binary_search(found.begin(), found.end(), BroadPhase::Pair{q, l}))
          << where << " query " << q << " leaf " << l;
    }
  }
  return overlaps;
}

/// Fresh sets of boxes; an update forgets what was before.
inline void checkUpdates(BroadPhase& broad, std::uint64_t seed) {
  Random random(seed);
  std::size_t overlaps = 0;
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<Box> leaves(trial == 0 ? 0 : 1 + random.next() % 300);
    std::vector<Box> queries(random.next() % 60);
    for (Box& box : leaves) box = randomBox(random);
    for (Box& box : queries) box = randomBox(random);
    broad.update(leaves);
    overlaps += expectSuperset(broad, leaves, queries, "trial " + std::to_string(trial));
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(overlaps, 500U) << "too few overlaps to tell anything";
}

/// The same leaves, some of which move: a little, far, or into another size.
inline void checkRefits(BroadPhase& broad, std::uint64_t seed) {
  Random random(seed);
  std::vector<Box> leaves(200);
  for (Box& box : leaves) box = randomBox(random);
  broad.update(leaves);
  std::size_t overlaps = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const double part = random.uniform() < 0.2 ? 1.0 : (random.uniform() < 0.2 ? 0.0 : 0.15);
    std::vector<std::uint32_t> changed;
    for (std::uint32_t l = 0; l < leaves.size(); ++l) {
      if (random.uniform() >= part) continue;
      changed.push_back(l);
      if (random.uniform() < 0.3) {
        leaves[l] = randomBox(random);
        continue;
      }
      const Vec3 by = 0.005 * Vec3(random.normal(), random.normal(), random.normal());
      leaves[l].lower += by;
      leaves[l].upper += by;
    }
    broad.refit(leaves, changed);
    std::vector<Box> queries(40);
    for (Box& box : queries) box = randomBox(random);
    overlaps += expectSuperset(broad, leaves, queries, "refit " + std::to_string(trial));
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(overlaps, 1000U) << "too few overlaps to tell anything";
}

/// Boxes that meet in one number, which no float holds: rounding inward would lose them.
inline void checkTightBoxes(BroadPhase& broad, std::uint64_t seed) {
  Random random(seed);
  for (int trial = 0; trial < 3000; ++trial) {
    Box leaf;
    Box query;
    const double scale = random.uniform() < 0.1 ? 1e8 : (random.uniform() < 0.1 ? 1e-42 : 1.0);
    for (int a = 0; a < 3; ++a) {
      const double meet = scale * random.normal();
      const double size = 0.01 * scale;
      leaf.lower[a] = meet - size * random.uniform();
      leaf.upper[a] = meet;
      query.lower[a] = meet;
      query.upper[a] = meet + size * random.uniform();
      if (random.uniform() < 0.5) {
        std::swap(leaf.lower[a], query.lower[a]);
        std::swap(leaf.upper[a], query.upper[a]);
      }
    }
    broad.update({&leaf, 1});
    std::vector<BroadPhase::Pair> found;
    broad.pairs({&query, 1}, found);
    ASSERT_EQ(found.size(), 1U) << "trial " << trial;
  }
}

}  // namespace calot::test
