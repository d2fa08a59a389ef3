// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/rest_compliance.h"

#include <algorithm>

#include "sim/math/floating_point.h"

namespace calot {

RestCompliance::RestCompliance(const SolidModel& model, const SolidSolver::Settings& settings, Executor& executor,
                               const Surroundings& surroundings)
    : model_(model), settings_(settings), column_(model.nodes()) {
  const FloatingPointScope scope;
  SolidState rest = restState(model);
  solver_.freeMotion(model, rest, Vec3::Zero(), {}, settings_, executor, surroundings);
}

void RestCompliance::require(std::span<const int> nodes, Executor& executor) {
  // A batch always holds the same right-hand sides for the same columns: iterations stop together, so a column's bits
  // would otherwise depend on its company. Two neighbouring numbers, three axes each, make a batch of six.
  for (const int asked : nodes) {
    const auto first = static_cast<std::size_t>(asked) / 2 * 2;
    if (!column_[static_cast<std::size_t>(asked)].empty()) continue;
    const std::size_t last = std::min(first + 2, model_.nodes());
    impulses_.clear();
    for (std::size_t node = first; node < last; ++node) {
      for (int axis = 0; axis < 3; ++axis) {
        SolidSolver::Impulse impulse;
        impulse.node[0] = static_cast<int>(node);
        impulse.weight[0] = 1.0;
        impulse.count = 1;
        impulse.impulse = Vec3::Unit(axis);
        impulses_.push_back(impulse);
      }
    }
    solver_.responses(model_, impulses_, settings_, response_, executor);
    for (std::size_t node = first; node < last; ++node) {
      std::vector<float>& column = column_[node];
      column.resize(9 * model_.nodes());
      for (std::size_t a = 0; a < model_.nodes(); ++a) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const Vec3& v = response_[3 * (node - first) + axis][a];
          for (std::size_t i = 0; i < 3; ++i) {
            column[9 * a + 3 * i + axis] = static_cast<float>(v[static_cast<int>(i)]);
          }
        }
      }
    }
  }
}

Mat3 RestCompliance::block(int a, int b) const {
  const float* c = column_[static_cast<std::size_t>(b)].data() + 9 * static_cast<std::size_t>(a);
  Mat3 m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) = static_cast<double>(c[3 * i + j]);
  }
  return m;
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
