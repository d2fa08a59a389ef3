// SPDX-License-Identifier: GPL-3.0-or-later
// Random block systems with the same as dense matrices in double.
#pragma once

#include <algorithm>
#include <array>
#include <Eigen/Dense>
#include <set>
#include <vector>

#include "sim/math/random.h"
#include "sim/solid/block_matrix.h"
#include "sim/solid/sweeps.h"

namespace calot::test {

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
inline System randomSystem(int nodes, int pairs, Random& random) {
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

/// One node, less than a slice, whole slices, one more, and more slices than one piece has.
inline constexpr int sizes[] = {1, 5, 8, 9, 16, 31, 140};

}  // namespace calot::test
