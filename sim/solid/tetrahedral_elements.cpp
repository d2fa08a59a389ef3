// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/tetrahedral_elements.h"

#include <algorithm>
#include <cmath>

#include "sim/math/floating_point.h"

namespace calot {

namespace {

constexpr std::size_t groupsPerTask = 16;

/// Node values of one group, lane-wise.
using NodeLanes = std::array<std::array<std::array<double, laneCount>, 3>, 4>;

void gather(const ElementGroup& group, std::span<const Vec3> values, NodeLanes& out) {
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t l = 0; l < laneCount; ++l) {
      const Vec3& v = values[static_cast<std::size_t>(group.node[a][l])];
      for (std::size_t i = 0; i < 3; ++i) out[a][i][l] = v[static_cast<int>(i)];
    }
  }
}

/// F = sum_a x_a grad_a^T.
CALOT_LANE_KERNEL void deformation(const NodeLanes& x, const ElementGroup& group, DeformationLanes& f) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t l = 0; l < laneCount; ++l) {
        f[i][j][l] = ((x[0][i][l] * group.gradient[0][j][l] + x[1][i][l] * group.gradient[1][j][l]) +
                      x[2][i][l] * group.gradient[2][j][l]) +
                     x[3][i][l] * group.gradient[3][j][l];
      }
    }
  }
}

CALOT_LANE_KERNEL void forces(const NodeLanes& x, const ElementGroup& group, LameConstants material,
                              const RotationGroup& q, ElementResult& out) {
  const double lambda = material.lambda;
  const double mu = material.mu;
  for (std::size_t l = 0; l < laneCount; ++l) {
    const double w = q[0][l];
    const double qx = q[1][l];
    const double qy = q[2][l];
    const double qz = q[3][l];
    double r[3][3];
    r[0][0] = 1.0 - 2.0 * (qy * qy + qz * qz);
    r[0][1] = 2.0 * (qx * qy - w * qz);
    r[0][2] = 2.0 * (qx * qz + w * qy);
    r[1][0] = 2.0 * (qx * qy + w * qz);
    r[1][1] = 1.0 - 2.0 * (qx * qx + qz * qz);
    r[1][2] = 2.0 * (qy * qz - w * qx);
    r[2][0] = 2.0 * (qx * qz - w * qy);
    r[2][1] = 2.0 * (qy * qz + w * qx);
    r[2][2] = 1.0 - 2.0 * (qx * qx + qy * qy);
    double f[3][3];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        f[i][j] = ((x[0][i][l] * group.gradient[0][j][l] + x[1][i][l] * group.gradient[1][j][l]) +
                   x[2][i][l] * group.gradient[2][j][l]) +
                  x[3][i][l] * group.gradient[3][j][l];
      }
    }
    double b[3][3];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        b[i][j] = (r[0][i] * f[0][j] + r[1][i] * f[1][j]) + r[2][i] * f[2][j];
      }
    }
    const double e00 = b[0][0] - 1.0;
    const double e11 = b[1][1] - 1.0;
    const double e22 = b[2][2] - 1.0;
    const double trace = lambda * ((e00 + e11) + e22);
    const double s00 = 2.0 * mu * e00 + trace;
    const double s11 = 2.0 * mu * e11 + trace;
    const double s22 = 2.0 * mu * e22 + trace;
    const double s01 = mu * (b[0][1] + b[1][0]);
    const double s02 = mu * (b[0][2] + b[2][0]);
    const double s12 = mu * (b[1][2] + b[2][1]);
    double p[3][3];
    for (std::size_t i = 0; i < 3; ++i) {
      p[i][0] = (r[i][0] * s00 + r[i][1] * s01) + r[i][2] * s02;
      p[i][1] = (r[i][0] * s01 + r[i][1] * s11) + r[i][2] * s12;
      p[i][2] = (r[i][0] * s02 + r[i][1] * s12) + r[i][2] * s22;
    }
    const double volume = group.volume[l];
    for (std::size_t a = 0; a < 4; ++a) {
      const double g0 = group.gradient[a][0][l];
      const double g1 = group.gradient[a][1][l];
      const double g2 = group.gradient[a][2][l];
      for (std::size_t i = 0; i < 3; ++i) {
        out.force[a][i][l] = -volume * ((p[i][0] * g0 + p[i][1] * g1) + p[i][2] * g2);
        out.gradient[a][i][l] = static_cast<float>((r[i][0] * g0 + r[i][1] * g1) + r[i][2] * g2);
      }
    }
  }
}

}  // namespace

LameConstants lameConstants(double youngModulus, double poissonRatio) {
  return {youngModulus * poissonRatio / ((1.0 + poissonRatio) * (1.0 - 2.0 * poissonRatio)),
          youngModulus / (2.0 * (1.0 + poissonRatio))};
}

TetrahedralElements::TetrahedralElements(std::span<const Vec3> rest, std::span<const Index4> tetrahedra)
    : count_(tetrahedra.size()), groups_(laneGroups(tetrahedra.size())) {
  for (std::size_t e = 0; e < groups_.size() * laneCount; ++e) {
    const Index4& t = tetrahedra[std::min(e, count_ - 1)];
    ElementGroup& group = groups_[e / laneCount];
    const std::size_t l = e % laneCount;
    std::array<Vec3, 4> p;
    for (std::size_t a = 0; a < 4; ++a) {
      group.node[a][l] = t[static_cast<int>(a)];
      p[a] = rest[static_cast<std::size_t>(group.node[a][l])];
    }
    const double sixVolumes = (p[1] - p[0]).dot((p[2] - p[0]).cross(p[3] - p[0]));
    std::array<Vec3, 4> gradient;
    gradient[1] = (p[2] - p[0]).cross(p[3] - p[0]) / sixVolumes;
    gradient[2] = (p[3] - p[0]).cross(p[1] - p[0]) / sixVolumes;
    gradient[3] = (p[1] - p[0]).cross(p[2] - p[0]) / sixVolumes;
    gradient[0] = -((gradient[1] + gradient[2]) + gradient[3]);
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t i = 0; i < 3; ++i) group.gradient[a][i][l] = gradient[a][static_cast<int>(i)];
    }
    group.volume[l] = e < count_ ? sixVolumes / 6.0 : 0.0;
  }
}

void TetrahedralElements::evaluate(std::span<const Vec3> position, std::span<const Vec3> velocity, double lookAhead,
                                   LameConstants material, int sweeps, std::span<RotationGroup> rotation,
                                   std::span<ElementResult> result, Executor& executor) const {
  const std::size_t tasks = (groups_.size() + groupsPerTask - 1) / groupsPerTask;
  executor.run(tasks, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t end = std::min(groups_.size(), (task + 1) * groupsPerTask);
    for (std::size_t g = task * groupsPerTask; g < end; ++g) {
      NodeLanes x;
      NodeLanes v;
      DeformationLanes f;
      gather(groups_[g], position, x);
      deformation(x, groups_[g], f);
      turnTowardsPolar(f, sweeps, rotation[g]);
      gather(groups_[g], velocity, v);
      for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t l = 0; l < laneCount; ++l) x[a][i][l] += lookAhead * v[a][i][l];
        }
      }
      forces(x, groups_[g], material, rotation[g], result[g]);
    }
  });
}

double TetrahedralElements::volume(std::span<const Vec3> position) const {
  double sum = 0.0;
  for (std::size_t e = 0; e < count_; ++e) {
    const ElementGroup& group = groups_[e / laneCount];
    const std::size_t l = e % laneCount;
    const Vec3& p0 = position[static_cast<std::size_t>(group.node[0][l])];
    const Vec3 a = position[static_cast<std::size_t>(group.node[1][l])] - p0;
    const Vec3 b = position[static_cast<std::size_t>(group.node[2][l])] - p0;
    const Vec3 c = position[static_cast<std::size_t>(group.node[3][l])] - p0;
    sum += a.dot(b.cross(c));
  }
  return sum / 6.0;
}

}  // namespace calot
