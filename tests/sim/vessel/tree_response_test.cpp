// SPDX-License-Identifier: GPL-3.0-or-later
// A forest's response in floats is that of the exact substitution.
#include "sim/vessel/beam_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "sim/math/random.h"

namespace calot {
namespace {

constexpr std::uint64_t seed = 20261125;

/// Chains that branch and several roots, blocks positive definite and far from diagonal.
struct Forest {
  std::vector<int> parent;
  BlockTree tree;

  explicit Forest(Random& random) {
    for (int n = 0; n < 40; ++n) {
      const bool root = n == 0 || n == 17;
      parent.push_back(root ? -1 : n % 7 == 3 ? std::max(n - 5, n < 17 ? 0 : 17) : n - 1);
    }
    tree.reset(parent.size());
    for (std::size_t n = 0; n < parent.size(); ++n) {
      // Of each link the square of a random 6 x 12 matrix: what springs between both ends add.
      std::array<std::array<double, 12>, 6> link{};
      for (auto& row : link) {
        for (double& x : row) x = random.normal();
      }
      for (std::size_t i = 0; i < 6; ++i) tree.diagonal(n)[7 * i] += 0.5;
      if (parent[n] < 0) continue;
      Block6& above = tree.diagonal(static_cast<std::size_t>(parent[n]));
      for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < 6; ++j) {
          for (const auto& row : link) {
            tree.diagonal(n)[6 * i + j] += row[i] * row[j];
            tree.coupling(n)[6 * i + j] += row[i] * row[6 + j];
            above[6 * i + j] += row[6 + i] * row[6 + j];
          }
        }
      }
    }
  }
};

TEST(TreeResponse, IsThatOfTheTree) {
  Random random(seed);
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  for (int trial = 0; trial < 20; ++trial) {
    Forest forest(random);
    ASSERT_TRUE(forest.tree.factor(forest.parent));
    std::vector<std::uint32_t> touched;
    for (std::uint32_t n = 0; n < forest.parent.size(); ++n) {
      if (random.uniform() < 0.3) touched.push_back(n);
    }
    TreeResponse response;
    response.precompute(forest.tree, forest.parent, touched);
    std::vector<Vector6> exact(forest.parent.size(), Vector6{});
    std::vector<FourFloats> push;
    for (const std::uint32_t n : touched) {
      FourFloats f{};
      for (std::size_t i = 0; i < 3; ++i) {
        f[i] = static_cast<float>(random.normal());
        exact[n][i] = static_cast<double>(f[i]);
      }
      push.push_back(f);
    }
    forest.tree.solve(forest.parent, exact);
    response.solve(push);
    double largest = 0.0;
    double off = 0.0;
    for (std::size_t k = 0; k < touched.size(); ++k) {
      for (std::size_t i = 0; i < 3; ++i) {
        largest = std::max(largest, std::abs(exact[touched[k]][i]));
        off = std::max(off, std::abs(exact[touched[k]][i] - static_cast<double>(push[k][i])));
      }
      EXPECT_EQ(push[k][3], 0.0F);
    }
    EXPECT_LT(off, 2e-5 * largest) << "trial " << trial;
  }
}

TEST(TreeResponse, OfNoNodeIsNothing) {
  Random random(seed);
  Forest forest(random);
  ASSERT_TRUE(forest.tree.factor(forest.parent));
  TreeResponse response;
  response.precompute(forest.tree, forest.parent, {});
  response.solve({});
}

}  // namespace
}  // namespace calot
