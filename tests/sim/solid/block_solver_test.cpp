// SPDX-License-Identifier: GPL-3.0-or-later
// Block matrix and Gauss-Seidel sweeps against dense algebra in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <Eigen/Dense>
#include <set>
#include <vector>

#include "sim/math/random.h"
#include "sim/solid/block_matrix.h"
#include "sim/solid/sweeps.h"
#include "tests/sim/solid/support/block_system.h"

namespace calot {
namespace {

using test::randomSystem;
using test::sizes;
using test::System;

TEST(BlockMatrix, NeighboursNeverShareAColour) {
  SCOPED_TRACE("seed 31");
  Random random(31);
  for (const int nodes : {1, 2, 30, 400}) {
    std::vector<std::set<int>> sets(static_cast<std::size_t>(nodes));
    for (int k = 0; k < 4 * nodes; ++k) {
      const auto i = static_cast<int>(random.uniform() * nodes);
      const auto j = static_cast<int>(random.uniform() * nodes);
      if (i == j) continue;
      sets[static_cast<std::size_t>(i)].insert(j);
      sets[static_cast<std::size_t>(j)].insert(i);
    }
    std::vector<std::vector<int>> graph;
    std::size_t most = 0;
    for (const std::set<int>& list : sets) {
      graph.emplace_back(list.begin(), list.end());
      most = std::max(most, list.size());
    }
    const std::vector<std::vector<int>> colours = coloured(graph);
    EXPECT_LE(colours.size(), most + 1) << "first fit needs no more";
    std::vector<int> seen(static_cast<std::size_t>(nodes), 0);
    for (const std::vector<int>& colour : colours) {
      EXPECT_TRUE(std::is_sorted(colour.begin(), colour.end()));
      for (const int a : colour) {
        ++seen[static_cast<std::size_t>(a)];
        for (const int b : colour) EXPECT_EQ(sets[static_cast<std::size_t>(a)].count(b), 0U);
      }
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), nodes);
  }
}

TEST(Sweeps, SolveTheTriangles) {
  SCOPED_TRACE("seed 32");
  Random random(32);
  for (const int nodes : sizes) {
    const System system = randomSystem(nodes, 3 * nodes, random);
    const std::vector<float> inverse = system.inverses();
    const sweeps::Slices slices = system.slices(inverse);
    std::vector<float> found(inverse.size(), 7.0F);
    sweeps::invertDiagonal(slices, found.data());
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_NEAR(found[k], inverse[k], 1e-6F * (1.0F + std::abs(inverse[k])));
    }
    const Eigen::VectorXd b = system.randomVector(random);
    const std::vector<float> packed = system.packed(b);
    const std::vector<float> zero(packed.size(), 0.0F);
    const std::vector<float> rows = system.byRows(b);
    std::vector<float> s(packed.size(), 0.0F);
    std::vector<float> sRows(rows.size(), 0.0F);
    std::array<double, laneCount> dot{};
    sweeps::forward(slices, rows.data(), s.data(), sRows.data(), packed.data(), zero.data(), dot.data());
    const Eigen::VectorXd wanted = system.lower().partialPivLu().solve(b);
    EXPECT_LT((system.unpacked(s) - wanted).norm(), 1e-5 * wanted.norm()) << nodes << " nodes";
    EXPECT_EQ(sRows, system.byRows(system.unpacked(s)));
    double total = 0.0;
    for (const double d : dot) total += d;
    EXPECT_NEAR(total, b.dot(wanted), 1e-5 * b.norm() * wanted.norm());

    std::vector<float> p(packed.size(), 0.0F);
    std::vector<float> t(packed.size(), 0.0F);
    std::vector<float> u(rows.size(), 0.0F);
    sweeps::backward(slices, packed.data(), 0.0F, p.data(), t.data(), u.data());
    EXPECT_EQ(p, packed);
    const Eigen::VectorXd up = system.lower().transpose().partialPivLu().solve(b);
    EXPECT_LT((system.unpacked(t) - up).norm(), 1e-5 * up.norm()) << nodes << " nodes";
    const Eigen::VectorXd off = (system.lower().transpose() - system.blockDiagonal()) * up;
    const std::vector<float> wantedRows = system.byRows(off);
    double worst = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) {
      worst = std::max(worst, std::abs(static_cast<double>(u[i]) - static_cast<double>(wantedRows[i])));
    }
    EXPECT_LT(worst, 1e-5 * (off.norm() + up.norm())) << nodes << " nodes";
  }
}

/// A sweep back and one forth together multiply by the matrix and solve both triangles.
TEST(Sweeps, InPairsMultiplyAndSolve) {
  SCOPED_TRACE("seed 34");
  Random random(34);
  for (const int nodes : sizes) {
    const System system = randomSystem(nodes, 3 * nodes, random);
    const std::vector<float> inverse = system.inverses();
    const sweeps::Slices slices = system.slices(inverse);
    const Eigen::VectorXd z = system.randomVector(random);
    const Eigen::VectorXd c = system.randomVector(random);
    const Eigen::VectorXd before = system.randomVector(random);
    constexpr float beta = 0.75F;
    const Eigen::VectorXd p = system.lower().transpose().partialPivLu().solve(z) + c + 0.75 * before;
    const Eigen::VectorXd q = system.dense * p;
    const Eigen::VectorXd s = system.lower().partialPivLu().solve(q);

    std::vector<float> direction = system.packed(before);
    std::vector<float> uw(2 * system.matrix.rows() * rowStride, 0.0F);
    std::vector<float> pq(uw.size(), 0.0F);
    std::vector<float> product(direction.size(), 7.0F);
    std::vector<float> solved(direction.size(), 7.0F);
    std::array<double, laneCount> dot{};
    sweeps::backwardPairs(slices, system.packed(z).data(), system.packed(c).data(), beta, direction.data(), uw.data(),
                          pq.data());
    sweeps::forwardPairs(slices, direction.data(), uw.data(), pq.data(), product.data(), solved.data(), dot.data());
    EXPECT_LT((system.unpacked(direction) - p).norm(), 1e-5 * p.norm()) << nodes << " nodes";
    EXPECT_LT((system.unpacked(product) - q).norm(), 1e-5 * q.norm()) << nodes << " nodes";
    EXPECT_LT((system.unpacked(solved) - s).norm(), 3e-5 * s.norm()) << nodes << " nodes";
    double total = 0.0;
    for (const double d : dot) total += d;
    EXPECT_NEAR(total, p.dot(q), 1e-5 * p.norm() * q.norm());
  }
}

}  // namespace
}  // namespace calot
