// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/solid.h"

#include <algorithm>
#include <utility>

#include "sim/math/floating_point.h"

namespace calot {

RestCompliance::RestCompliance(const SolidModel& model, const SolidSolver::Settings& settings, Executor& executor,
                               const Surroundings& surroundings, const ComplianceShelf& shelf)
    : model_(model), settings_(settings), shelf_(shelf), column_(model.nodes()), fresh_(model.nodes()) {
  const FloatingPointScope scope;
  settings_.lattice = false;  // not used with several right-hand sides
  SolidState rest = restState(model);
  solver_.solveUnconstrained(model, rest, Vec3::Zero(), {}, settings_, executor, surroundings);
}

void RestCompliance::precomputeCompliance(std::span<const int> nodes) {
  // Eight right-hand sides cost as much as one, and lanes converge independently. Spare lanes compute the following
  // nodes, which are likely to be requested as well.
  pending_.clear();
  const auto request = [this](std::size_t node) {
    if (column_[node] != nullptr || !fresh_[node].empty()) return;
    if (shelf_.store != nullptr) column_[node] = shelf_.store->find(shelf_.solid, node);
    if (column_[node] != nullptr) return;
    fresh_[node].resize(9 * model_.nodes());
    for (std::size_t axis = 0; axis < 3; ++axis) pending_.emplace_back(node, axis);
  };
  for (const int node : nodes) request(static_cast<std::size_t>(node));
  const std::size_t capacity = laneGroups(pending_.size()) * laneCount;
  for (const int node : nodes) {
    const std::size_t next = static_cast<std::size_t>(node) ^ 1U;
    if (pending_.size() + 3 <= capacity && next < model_.nodes()) request(next);
  }
  for (std::size_t from = 0; from < pending_.size(); from += laneCount) {
    const std::size_t count = std::min(pending_.size() - from, std::size_t{laneCount});
    impulses_.assign(count, {});
    for (std::size_t k = 0; k < count; ++k) {
      const auto [node, axis] = pending_[from + k];
      impulses_[k].node[0] = static_cast<int>(node);
      impulses_[k].weight[0] = 1.0;
      impulses_[k].count = 1;
      impulses_[k].impulse = Vec3::Unit(static_cast<int>(axis));
    }
    solver_.responses(model_, impulses_, settings_, response_);
    for (std::size_t k = 0; k < count; ++k) {
      const auto [node, axis] = pending_[from + k];
      for (std::size_t a = 0; a < model_.nodes(); ++a) {
        const Vec3& v = response_[k][a];
        for (std::size_t i = 0; i < 3; ++i) {
          fresh_[node][9 * a + 3 * i + axis] = static_cast<float>(v[static_cast<int>(i)]);
        }
      }
    }
  }
  for (const auto& [node, axis] : pending_) {
    if (axis != 0) continue;
    column_[node] = shelf_.store == nullptr ? fresh_[node].data()
                                            : shelf_.store->keep(shelf_.solid, node, std::exchange(fresh_[node], {}));
  }
}

Mat3 RestCompliance::block(int a, int b) const {
  const float* c = column_[static_cast<std::size_t>(b)] + 9 * static_cast<std::size_t>(a);
  Mat3 m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) = static_cast<double>(c[3 * i + j]);
  }
  return m;
}

void RestCompliance::blocks(std::span<const int> a, std::span<const int> b, std::span<double> out) const {
  for (std::size_t j = 0; j < b.size(); ++j) {
    const float* column = column_[static_cast<std::size_t>(b[j])];
    for (std::size_t i = 0; i < a.size(); ++i) {
      const float* from = column + 9 * static_cast<std::size_t>(a[i]);
      double* to = out.data() + 9 * (i * b.size() + j);
      for (std::size_t k = 0; k < 9; ++k) to[k] = static_cast<double>(from[k]);
    }
  }
}

Quat nodeRotation(const SolidModel& model, const SolidState& state, int node) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  Eigen::Vector4d first = Eigen::Vector4d::Zero();
  for (const std::int32_t element : model.elementsAt(static_cast<std::size_t>(node))) {
    const auto e = static_cast<std::size_t>(element);
    Eigen::Vector4d q;
    for (int i = 0; i < 4; ++i) {
      q[i] = static_cast<double>(state.rotation[e / laneCount][static_cast<std::size_t>(i)][e % laneCount]);
    }
    if (first.isZero(0.0)) first = q;
    sum += q.dot(first) < 0.0 ? Eigen::Vector4d(-q) : q;
  }
  const double size = sum.norm();
  if (!(size > 1e-6)) return Quat::Identity();
  return {sum[0] / size, sum[1] / size, sum[2] / size, sum[3] / size};
}

}  // namespace calot
