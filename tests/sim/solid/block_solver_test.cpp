// SPDX-License-Identifier: GPL-3.0-or-later
// Block matrix, Gauss-Seidel sweeps and conjugate gradients against dense algebra in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <Eigen/Dense>
#include <limits>
#include <set>
#include <vector>

#include "sim/math/random.h"
#include "sim/solid/block_matrix.h"
#include "sim/solid/conjugate_gradient.h"
#include "sim/solid/sweeps.h"

namespace calot {
namespace {

/// A symmetric positive definite block system in rows by colours, from blocks of nodes.
struct System {
  std::vector<int> row;  // of each node
  BlockMatrix matrix;
  std::vector<float> values;
  Eigen::MatrixXd dense;  // of the float values, by rows; padding rows are nothing

  /// @param blocks symmetric, of nodes; @param near per node: those that it has a block with, without itself
  System(const Eigen::MatrixXd& blocks, const std::vector<std::set<int>>& near) {
    std::vector<std::vector<int>> graph;
    graph.reserve(near.size());
    for (const std::set<int>& list : near) graph.emplace_back(list.begin(), list.end());
    row.assign(near.size(), -1);
    std::size_t rows = 0;
    for (const std::vector<int>& colour : coloured(graph)) {
      for (std::size_t i = 0; i < colour.size(); ++i) {
        row[static_cast<std::size_t>(colour[i])] = static_cast<int>(rows + i);
      }
      rows += laneGroups(colour.size()) * laneCount;
    }
    std::vector<std::vector<int>> columns(rows);
    for (std::size_t n = 0; n < near.size(); ++n) {
      std::vector<int>& own = columns[static_cast<std::size_t>(row[n])];
      own.push_back(row[n]);
      for (const int other : near[n]) {
        if (row[static_cast<std::size_t>(other)] < row[n]) own.push_back(row[static_cast<std::size_t>(other)]);
      }
      std::sort(own.begin(), own.end());
    }
    matrix = BlockMatrix(columns);
    values.assign(matrix.valueCount(), 0.0F);
    dense = Eigen::MatrixXd::Zero(static_cast<int>(3 * rows), static_cast<int>(3 * rows));
    std::vector<int> node(rows, -1);
    for (std::size_t n = 0; n < row.size(); ++n) node[static_cast<std::size_t>(row[n])] = static_cast<int>(n);
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t k = 0; k < columns[r].size(); ++k) {
        const int c = columns[r][k];
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            const auto value = static_cast<float>(blocks(3 * node[r] + i, 3 * node[static_cast<std::size_t>(c)] + j));
            values[matrix.slot(r, k) + 8 * static_cast<std::size_t>(3 * i + j)] = value;
            dense(3 * static_cast<int>(r) + i, 3 * c + j) = static_cast<double>(value);
            dense(3 * c + j, 3 * static_cast<int>(r) + i) = static_cast<double>(value);
          }
        }
      }
    }
  }

  [[nodiscard]] int size() const { return static_cast<int>(dense.rows()); }
  [[nodiscard]] bool isPadding(int entry) const { return std::find(row.begin(), row.end(), entry / 3) == row.end(); }
  /// The matrix with 1 on the diagonal of rows that only fill up: it has an inverse.
  [[nodiscard]] Eigen::MatrixXd whole() const {
    Eigen::MatrixXd a = dense;
    for (int i = 0; i < size(); ++i) {
      if (isPadding(i)) a(i, i) = 1.0;
    }
    return a;
  }
  /// D + L, in blocks of rows.
  [[nodiscard]] Eigen::MatrixXd lower() const {
    Eigen::MatrixXd a = whole();
    for (int i = 0; i < size(); ++i) {
      for (int j = 0; j < size(); ++j) {
        if (j / 3 > i / 3) a(i, j) = 0.0;
      }
    }
    return a;
  }
  [[nodiscard]] Eigen::MatrixXd blockDiagonal() const {
    Eigen::MatrixXd a = whole();
    for (int i = 0; i < size(); ++i) {
      for (int j = 0; j < size(); ++j) {
        if (j / 3 != i / 3) a(i, j) = 0.0;
      }
    }
    return a;
  }
  /// (D + L) D^-1 (D + L)^T.
  [[nodiscard]] Eigen::MatrixXd preconditioner() const {
    return lower() * blockDiagonal().inverse() * lower().transpose();
  }
  [[nodiscard]] std::vector<float> inverses() const {
    const Eigen::MatrixXd inverse = blockDiagonal().inverse();
    std::vector<float> out(matrix.slices() * 9 * laneCount, 0.0F);
    for (std::size_t r = 0; r < matrix.rows(); ++r) {
      const int first = 3 * static_cast<int>(r);
      if (isPadding(first)) continue;
      for (int k = 0; k < 9; ++k) {
        out[(r / laneCount * 9 + static_cast<std::size_t>(k)) * laneCount + r % laneCount] =
            static_cast<float>(inverse(first + k / 3, first + k % 3));
      }
    }
    return out;
  }

  [[nodiscard]] sweeps::Slices slices(const std::vector<float>& inverse) const {
    return {
        values.data(),  inverse.data(), matrix.column(0), matrix.firstColumns().data(), matrix.diagonalColumns().data(),
        matrix.slices()};
  }

  [[nodiscard]] Eigen::VectorXd randomVector(Random& random) const {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(size());
    for (int i = 0; i < size(); ++i) {
      if (!isPadding(i)) v[i] = static_cast<double>(static_cast<float>(random.normal()));
    }
    return v;
  }
  static std::size_t at(int entry) {
    return laneOffset(static_cast<std::size_t>(entry / 3)) + 8 * static_cast<std::size_t>(entry % 3);
  }
  static std::size_t atMany(int entry, int k) {
    return static_cast<std::size_t>(entry / 3) * laneStride + 8 * static_cast<std::size_t>(entry % 3) +
           static_cast<std::size_t>(k);
  }
  [[nodiscard]] std::vector<float> packed(const Eigen::VectorXd& v) const {
    std::vector<float> out(matrix.vectorSize(), 0.0F);
    for (int i = 0; i < size(); ++i) out[at(i)] = static_cast<float>(v[i]);
    return out;
  }
  [[nodiscard]] Eigen::VectorXd unpacked(const std::vector<float>& v) const {
    Eigen::VectorXd out(size());
    for (int i = 0; i < size(); ++i) out[i] = static_cast<double>(v[at(i)]);
    return out;
  }
  [[nodiscard]] std::vector<float> byRows(const Eigen::VectorXd& v) const {
    std::vector<float> out(matrix.rows() * rowStride, 0.0F);
    for (int i = 0; i < size(); ++i) {
      out[static_cast<std::size_t>(i / 3) * rowStride + static_cast<std::size_t>(i % 3)] = static_cast<float>(v[i]);
    }
    return out;
  }
  [[nodiscard]] std::vector<float> packedMany(const Eigen::MatrixXd& v) const {
    std::vector<float> out(matrix.vectorSize() * laneCount, 0.0F);
    for (int i = 0; i < size(); ++i) {
      for (int k = 0; k < v.cols(); ++k) out[atMany(i, k)] = static_cast<float>(v(i, k));
    }
    return out;
  }
  [[nodiscard]] Eigen::VectorXd unpackedMany(const std::vector<float>& v, int k) const {
    Eigen::VectorXd out(size());
    for (int i = 0; i < size(); ++i) out[i] = static_cast<double>(v[atMany(i, k)]);
    return out;
  }
};

/// Least eigenvalue of at least 1: the identity and a sum of G^T G over random pairs of nodes.
System randomSystem(int nodes, int pairs, Random& random) {
  Eigen::MatrixXd blocks = Eigen::MatrixXd::Identity(3 * nodes, 3 * nodes);
  std::vector<std::set<int>> near(static_cast<std::size_t>(nodes));
  for (int k = 0; k < pairs; ++k) {
    const auto i = static_cast<int>(random.uniform() * nodes);
    const auto j = static_cast<int>(random.uniform() * nodes);
    if (i == j) continue;
    Eigen::Matrix<double, 3, 6> g;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 6; ++b) g(a, b) = random.normal();
    }
    const Eigen::Matrix<double, 6, 6> block = g.transpose() * g;
    const int at[2] = {i, j};
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) blocks.block<3, 3>(3 * at[a], 3 * at[b]) += block.block<3, 3>(3 * a, 3 * b);
    }
    near[static_cast<std::size_t>(i)].insert(j);
    near[static_cast<std::size_t>(j)].insert(i);
  }
  return {blocks, near};
}

/// Springs along the edges of an n^3 grid, each a hundred times as stiff along itself, and a little mass.
System gridSystem(int n) {
  Eigen::MatrixXd blocks = 0.1 * Eigen::MatrixXd::Identity(3 * n * n * n, 3 * n * n * n);
  std::vector<std::set<int>> near(static_cast<std::size_t>(n * n * n));
  for (int i = 0; i < n * n * n; ++i) {
    const int at[3] = {i % n, i / n % n, i / (n * n)};
    const int step[3] = {1, n, n * n};
    for (int axis = 0; axis < 3; ++axis) {
      if (at[axis] + 1 == n) continue;
      const int j = i + step[axis];
      Eigen::Matrix3d k = 0.01 * Eigen::Matrix3d::Identity();
      k(axis, axis) = 1.0;
      blocks.block<3, 3>(3 * i, 3 * i) += k;
      blocks.block<3, 3>(3 * j, 3 * j) += k;
      blocks.block<3, 3>(3 * i, 3 * j) -= k;
      blocks.block<3, 3>(3 * j, 3 * i) -= k;
      near[static_cast<std::size_t>(i)].insert(j);
      near[static_cast<std::size_t>(j)].insert(i);
    }
  }
  return {blocks, near};
}

/// Iterations of conjugate gradients in double with the inverse of `preconditioner`, to a residual in its norm.
int iterationsWith(const Eigen::MatrixXd& a, const Eigen::MatrixXd& preconditioner, const Eigen::VectorXd& b,
                   double tolerance) {
  const Eigen::LLT<Eigen::MatrixXd> m(preconditioner);
  Eigen::VectorXd r = b;
  Eigen::VectorXd z = m.solve(r);
  Eigen::VectorXd p = z;
  double size = r.dot(z);
  const double goal = tolerance * tolerance * size;
  int iterations = 0;
  for (; size > goal; ++iterations) {
    const Eigen::VectorXd y = a * p;
    r -= size / p.dot(y) * y;
    z = m.solve(r);
    const double next = r.dot(z);
    p = z + next / size * p;
    size = next;
  }
  return iterations;
}

/// One node, less than a slice, whole slices, one more, and more slices than one piece has.
constexpr int sizes[] = {1, 5, 8, 9, 16, 31, 140};

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

/// The residual is that of the definition, and bounds the error: |e|_A <= sqrt(largest of M against A) |r|_M^-1.
TEST(ConjugateGradient, AgreesWithDenseFactorisation) {
  SCOPED_TRACE("seed 33");
  Random random(33);
  ConjugateGradient cg;  // one for all sizes: what an earlier system left behind must not matter
  for (const int nodes : sizes) {
    const System system = randomSystem(nodes, 2 * nodes, random);
    const Eigen::VectorXd b = system.randomVector(random);
    std::vector<float> x(system.matrix.vectorSize(), 7.0F);
    cg.precompute(system.matrix, system.values);
    constexpr double tolerance = 3e-5;
    const SolveReport report = cg.solve(system.matrix, system.values, system.packed(b), x, {tolerance, 1000});
    EXPECT_TRUE(report.converged) << nodes << " nodes";
    EXPECT_LE(report.residual, tolerance);
    EXPECT_GT(report.iterations, 0U);
    const Eigen::MatrixXd a = system.whole();
    const Eigen::MatrixXd m = system.preconditioner();
    const Eigen::VectorXd found = system.unpacked(x);
    const Eigen::VectorXd r = b - a * found;
    const double size = std::sqrt(b.dot(m.ldlt().solve(b)));
    EXPECT_LT(std::sqrt(r.dot(m.ldlt().solve(r))), 2.0 * tolerance * size) << nodes << " nodes: residual by recursion";
    const Eigen::VectorXd e = found - a.ldlt().solve(b);
    const double worst = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(m, a).eigenvalues().maxCoeff();
    EXPECT_LT(std::sqrt(e.dot(a * e)), 2.0 * std::sqrt(worst) * tolerance * size) << nodes << " nodes";
    for (int i = 0; i < system.size(); ++i) {
      if (system.isPadding(i)) {
        EXPECT_EQ(found[i], 0.0) << "padding";
      }
    }
  }
}

/// What is left to do counts by its energy: a small load is solved no farther than `least`, a smaller one not at all,
/// and the residual is told from what the tolerance is counted from.
TEST(ConjugateGradient, EndsWhereWhatIsLeftIsNotWorthAnIteration) {
  SCOPED_TRACE("seed 34");
  Random random(34);
  const System system = randomSystem(60, 120, random);
  const Eigen::VectorXd b = system.randomVector(random);
  const Eigen::MatrixXd m = system.preconditioner();
  const double size = std::sqrt(b.dot(m.ldlt().solve(b)));
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  std::vector<float> x(system.matrix.vectorSize());
  std::uint32_t before = 1000;
  for (const double share : {0.0, 1e-4, 1e-2, 0.3}) {
    const SolveGoal goal{1e-5, 1000, share * size};
    const SolveReport report = cg.solve(system.matrix, system.values, system.packed(b), x, goal);
    EXPECT_TRUE(report.converged) << share;
    EXPECT_LE(report.residual, goal.tolerance) << share;
    EXPECT_LT(report.iterations, before) << share;
    before = report.iterations;
    const Eigen::VectorXd r = b - system.whole() * system.unpacked(x);
    const double left = std::sqrt(r.dot(m.ldlt().solve(r)));
    EXPECT_LE(left, 2.0 * std::max(1e-5, share) * size) << share;
    if (share > 0.0) {
      EXPECT_NEAR(report.residual, 1e-5 * left / (share * size), 0.1 * report.residual + 1e-7);
    }
  }
  EXPECT_GT(before, 0U);
  const SolveReport none = cg.solve(system.matrix, system.values, system.packed(b), x, {1e-5, 1000, 1.01 * size});
  EXPECT_TRUE(none.converged);
  EXPECT_EQ(none.iterations, 0U);
  EXPECT_EQ(system.unpacked(x).norm(), 0.0);
  // A cap that binds is a miss, however little is asked for.
  EXPECT_FALSE(cg.solve(system.matrix, system.values, system.packed(b), x, {1e-5, 1, 1e-4 * size}).converged);
}

/// A loose solve and one that goes on from it are together one of both loads to the second's tolerance.
TEST(ConjugateGradient, GoesOnFromWhatWasLeftOpen) {
  SCOPED_TRACE("seed 36");
  Random random(36);
  const System system = randomSystem(60, 120, random);
  const Eigen::VectorXd first = system.randomVector(random);
  const Eigen::VectorXd second = 0.1 * system.randomVector(random);
  const Eigen::MatrixXd m = system.preconditioner();
  const auto sizeOf = [&](const Eigen::VectorXd& v) { return std::sqrt(v.dot(m.ldlt().solve(v))); };
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  std::vector<float> x(system.matrix.vectorSize());
  const auto solved = [&](const Eigen::VectorXd& b, double tolerance, bool goesOn) {
    SolveGoal goal{1e-9, 1000, tolerance * sizeOf(first)};
    goal.goesOn = goesOn;
    EXPECT_TRUE(cg.solve(system.matrix, system.values, system.packed(b), x, goal).converged);
    return system.unpacked(x);
  };
  const Eigen::VectorXd loose = solved(first, 0.1, false);
  const double open = sizeOf(first - system.whole() * loose);
  EXPECT_GT(open, 0.01 * sizeOf(first)) << "something is left to go on from";
  const Eigen::VectorXd whole = loose + solved(second, 1e-5, true);
  EXPECT_LT(sizeOf(first + second - system.whole() * whole), 3e-5 * sizeOf(first));
  const Eigen::VectorXd nothingMore = whole + solved(Eigen::VectorXd::Zero(second.size()), 1e-6, true);
  EXPECT_LT(sizeOf(first + second - system.whole() * nothingMore), 5e-6 * sizeOf(first)) << "without another load";
  const Eigen::VectorXd afresh = solved(second, 1e-6, false);
  EXPECT_LT(sizeOf(second - system.whole() * afresh), 5e-6 * sizeOf(first)) << "another solve starts from nothing";
}

TEST(ConjugateGradient, BlocksThatTheStructureHasNoPlaceFor) {
  SCOPED_TRACE("seed 37");
  Random random(37);
  const System system = randomSystem(40, 60, random);
  Eigen::MatrixXd a = system.whole();
  std::vector<ExtraBlock> extra;
  for (const auto& [i, j] : {std::pair(3, 31), std::pair(3, 17), std::pair(22, 9)}) {
    Eigen::Matrix<double, 3, 6> g;
    for (int k = 0; k < 18; ++k) g(k / 6, k % 6) = random.normal();
    const Eigen::Matrix<double, 6, 6> block = g.transpose() * g;
    const int at[2] = {system.row[static_cast<std::size_t>(i)], system.row[static_cast<std::size_t>(j)]};
    for (int p = 0; p < 2; ++p) {
      for (int q = 0; q < 2; ++q) {
        ExtraBlock& one = extra.emplace_back();
        one.row = static_cast<std::size_t>(at[p]);
        one.column = static_cast<std::size_t>(at[q]);
        for (int k = 0; k < 9; ++k) {
          one.value[static_cast<std::size_t>(k)] = static_cast<float>(block(3 * p + k / 3, 3 * q + k % 3));
          a(3 * at[p] + k / 3, 3 * at[q] + k % 3) += static_cast<double>(one.value[static_cast<std::size_t>(k)]);
        }
      }
    }
  }
  const Eigen::VectorXd b = system.randomVector(random);
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values, extra);
  std::vector<float> x(system.matrix.vectorSize());
  EXPECT_TRUE(cg.solve(system.matrix, system.values, system.packed(b), x, {1e-6, 1000}).converged);
  const Eigen::VectorXd wanted = a.ldlt().solve(b);
  EXPECT_LT((system.unpacked(x) - wanted).norm(), 2e-5 * wanted.norm());
  Eigen::MatrixXd two = Eigen::MatrixXd::Zero(system.size(), laneCount);
  two.col(0) = b;
  two.col(6) = -b;
  std::vector<float> many(x.size() * laneCount);
  EXPECT_TRUE(cg.solveMany(system.matrix, system.values, system.packedMany(two), many, 1e-6, 1000).converged);
  EXPECT_LT((system.unpackedMany(many, 0) - wanted).norm(), 2e-5 * wanted.norm());
  EXPECT_LT((system.unpackedMany(many, 6) + wanted).norm(), 2e-5 * wanted.norm());
}

/// As many iterations as the method takes in double, and less than half of those with the diagonal blocks alone.
TEST(ConjugateGradient, SweepsHalveTheIterations) {
  SCOPED_TRACE("seed 38");
  Random random(38);
  const System system = gridSystem(6);
  const Eigen::VectorXd b = system.randomVector(random);
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  std::vector<float> x(system.matrix.vectorSize());
  const SolveReport report = cg.solve(system.matrix, system.values, system.packed(b), x, {1e-4, 1000});
  const int sweeps = iterationsWith(system.whole(), system.preconditioner(), b, 1e-4);
  const int diagonal = iterationsWith(system.whole(), system.blockDiagonal(), b, 1e-4);
  RecordProperty("iterations", static_cast<int>(report.iterations));
  RecordProperty("iterations_diagonal", diagonal);
  EXPECT_NEAR(static_cast<int>(report.iterations), sweeps, 1);
  EXPECT_LT(2 * sweeps, diagonal + 4) << diagonal;
}

/// Each of eight right-hand sides comes out as it would alone, to the bit.
TEST(ConjugateGradient, CompanyChangesNoBit) {
  SCOPED_TRACE("seed 39");
  Random random(39);
  const System system = gridSystem(6);
  Eigen::MatrixXd b(system.size(), laneCount);
  for (int k = 0; k < laneCount; ++k) b.col(k) = system.randomVector(random) * (k % 3 == 0 ? 1e-3 : 1.0);
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  std::vector<float> together(system.matrix.vectorSize() * laneCount);
  EXPECT_TRUE(cg.solveMany(system.matrix, system.values, system.packedMany(b), together, 1e-4, 500).converged);
  for (int k = 0; k < laneCount; ++k) {
    Eigen::MatrixXd one = Eigen::MatrixXd::Zero(system.size(), laneCount);
    const int lane = (k + 3) % laneCount;
    one.col(lane) = b.col(k);
    std::vector<float> alone(together.size());
    EXPECT_TRUE(cg.solveMany(system.matrix, system.values, system.packedMany(one), alone, 1e-4, 500).converged);
    for (int i = 0; i < system.size(); ++i) {
      ASSERT_EQ(together[System::atMany(i, k)], alone[System::atMany(i, lane)]) << "vector " << k << ", entry " << i;
    }
  }
}

TEST(ConjugateGradient, EightRightHandSidesWithZerosAmongThem) {
  SCOPED_TRACE("seed 34");
  Random random(34);
  ConjugateGradient cg;
  for (const int nodes : sizes) {
    const System system = randomSystem(nodes, 2 * nodes, random);
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(system.size(), laneCount);
    for (const int k : {0, 1, 3, 6}) b.col(k) = system.randomVector(random) * (k == 3 ? 1e-6 : 1.0);
    std::vector<float> x(system.matrix.vectorSize() * laneCount, 7.0F);
    cg.precompute(system.matrix, system.values);
    constexpr double tolerance = 1e-5;
    const SolveReport report = cg.solveMany(system.matrix, system.values, system.packedMany(b), x, tolerance, 1000);
    EXPECT_TRUE(report.converged) << nodes << " nodes";
    EXPECT_LE(report.residual, tolerance);
    const Eigen::MatrixXd expected = system.whole().ldlt().solve(b);
    for (int k = 0; k < laneCount; ++k) {
      const Eigen::VectorXd found = system.unpackedMany(x, k);
      if (b.col(k).isZero(0.0)) {
        EXPECT_TRUE(found.isZero(0.0)) << "a zero right-hand side stays zero, vector " << k;
      } else {
        EXPECT_LT((found - expected.col(k)).norm(), 5.0 * tolerance * b.col(k).norm()) << nodes << " nodes, " << k;
      }
    }
  }
}

TEST(ConjugateGradient, ZeroRightHandSide) {
  Random random(35);
  const System system = randomSystem(20, 40, random);
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  const std::vector<float> b(system.matrix.vectorSize(), 0.0F);
  std::vector<float> x(b.size(), 7.0F);
  const SolveReport report = cg.solve(system.matrix, system.values, b, x, {1e-6, 100});
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 0U);
  EXPECT_EQ(report.residual, 0.0);
  EXPECT_EQ(x, b);
}

TEST(ConjugateGradient, ACapThatBindsIsReported) {
  Random random(36);
  const System system = randomSystem(140, 420, random);
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  const Eigen::VectorXd b = system.randomVector(random);
  std::vector<float> x(system.matrix.vectorSize());
  const SolveReport one = cg.solve(system.matrix, system.values, system.packed(b), x, {1e-6, 2});
  EXPECT_FALSE(one.converged);
  EXPECT_EQ(one.iterations, 2U);
  const Eigen::LDLT<Eigen::MatrixXd> m(system.preconditioner());
  const Eigen::VectorXd r = b - system.dense * system.unpacked(x);
  EXPECT_NEAR(one.residual, std::sqrt(r.dot(m.solve(r)) / b.dot(m.solve(b))), 1e-5);
  std::vector<float> many(x.size() * laneCount);
  Eigen::MatrixXd eight = Eigen::MatrixXd::Zero(system.size(), laneCount);
  eight.col(5) = b;
  const SolveReport column = cg.solveMany(system.matrix, system.values, system.packedMany(eight), many, 1e-6, 2);
  EXPECT_FALSE(column.converged);
  EXPECT_EQ(column.iterations, 2U);
  EXPECT_NEAR(column.residual, one.residual, 1e-5);
  EXPECT_LT((system.unpackedMany(many, 5) - system.unpacked(x)).norm(), 1e-5 * system.unpacked(x).norm());
}

/// Diagonal blocks are positive definite, the whole is not: [I 2I; 2I I] has the eigenvalue -1.
TEST(ConjugateGradient, AnIndefiniteMatrixIsNoSilentMiss) {
  Eigen::MatrixXd blocks = Eigen::MatrixXd::Identity(6, 6);
  blocks.block<3, 3>(0, 3) = blocks.block<3, 3>(3, 0) = 2.0 * Eigen::Matrix3d::Identity();
  const System system(blocks, {{1}, {0}});
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(system.size());
  b[3 * system.row[0]] = 1.0;
  b[3 * system.row[1]] = -1.0;
  std::vector<float> x(system.matrix.vectorSize());
  const SolveReport report = cg.solve(system.matrix, system.values, system.packed(b), x, {1e-6, 100});
  EXPECT_FALSE(report.converged);
  for (const float v : x) EXPECT_TRUE(std::isfinite(v));
}

TEST(ConjugateGradient, WhatIsNotFiniteIsAMissAndLeavesNoTrace) {
  SCOPED_TRACE("seed 40");
  Random random(40);
  const System system = randomSystem(30, 60, random);
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  const std::vector<float> good = system.packed(system.randomVector(random));
  std::vector<float> before(good.size());
  cg.solve(system.matrix, system.values, good, before, {1e-4, 100});
  std::vector<float> bad = good;
  bad[laneOffset(static_cast<std::size_t>(system.row[4]))] = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> x(good.size());
  EXPECT_FALSE(cg.solve(system.matrix, system.values, bad, x, {1e-4, 100}).converged);
  std::vector<float> after(good.size());
  EXPECT_TRUE(cg.solve(system.matrix, system.values, good, after, {1e-4, 100}).converged);
  EXPECT_EQ(before, after);
}

}  // namespace
}  // namespace calot
