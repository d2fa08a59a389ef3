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

/// Rotations: maximises tr(R^T F) by Newton's method on rotation increments. With B = R^T F, the gradient is
/// a = axial(B - B^T) and the Hessian -(tr(B) I - sym(B)); the increment enters the quaternion as (1, w/2), normalised,
/// so that the result is orthogonal whatever the step. Where the Hessian is not positive definite (inverted or very
/// flat elements) the step falls back to a / (|tr B| + |a|): a rotation of bounded angle in the same direction.
CALOT_LANE_KERNEL void rotate(const NodeLanes& x, const ElementGroup& group, int sweeps, RotationGroup& q) {
  for (std::size_t l = 0; l < laneCount; ++l) {
    double f[3][3];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        f[i][j] = ((x[0][i][l] * group.gradient[0][j][l] + x[1][i][l] * group.gradient[1][j][l]) +
                   x[2][i][l] * group.gradient[2][j][l]) +
                  x[3][i][l] * group.gradient[3][j][l];
      }
    }
    double w = q[0][l];
    double qx = q[1][l];
    double qy = q[2][l];
    double qz = q[3][l];
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      const double r00 = 1.0 - 2.0 * (qy * qy + qz * qz);
      const double r01 = 2.0 * (qx * qy - w * qz);
      const double r02 = 2.0 * (qx * qz + w * qy);
      const double r10 = 2.0 * (qx * qy + w * qz);
      const double r11 = 1.0 - 2.0 * (qx * qx + qz * qz);
      const double r12 = 2.0 * (qy * qz - w * qx);
      const double r20 = 2.0 * (qx * qz - w * qy);
      const double r21 = 2.0 * (qy * qz + w * qx);
      const double r22 = 1.0 - 2.0 * (qx * qx + qy * qy);
      const double b00 = (r00 * f[0][0] + r10 * f[1][0]) + r20 * f[2][0];
      const double b01 = (r00 * f[0][1] + r10 * f[1][1]) + r20 * f[2][1];
      const double b02 = (r00 * f[0][2] + r10 * f[1][2]) + r20 * f[2][2];
      const double b10 = (r01 * f[0][0] + r11 * f[1][0]) + r21 * f[2][0];
      const double b11 = (r01 * f[0][1] + r11 * f[1][1]) + r21 * f[2][1];
      const double b12 = (r01 * f[0][2] + r11 * f[1][2]) + r21 * f[2][2];
      const double b20 = (r02 * f[0][0] + r12 * f[1][0]) + r22 * f[2][0];
      const double b21 = (r02 * f[0][1] + r12 * f[1][1]) + r22 * f[2][1];
      const double b22 = (r02 * f[0][2] + r12 * f[1][2]) + r22 * f[2][2];
      const double a0 = b21 - b12;
      const double a1 = b02 - b20;
      const double a2 = b10 - b01;
      const double h00 = b11 + b22;
      const double h11 = b00 + b22;
      const double h22 = b00 + b11;
      const double h01 = -0.5 * (b01 + b10);
      const double h02 = -0.5 * (b02 + b20);
      const double h12 = -0.5 * (b12 + b21);
      const double c00 = h11 * h22 - h12 * h12;
      const double c01 = h02 * h12 - h01 * h22;
      const double c02 = h01 * h12 - h02 * h11;
      const double minor = h00 * h11 - h01 * h01;
      const double det = (h00 * c00 + h01 * c01) + h02 * c02;
      const double c11 = h00 * h22 - h02 * h02;
      const double c12 = h01 * h02 - h00 * h12;
      const double trace = (b00 + b11) + b22;
      const double length = std::sqrt((a0 * a0 + a1 * a1) + a2 * a2);
      const double scale = std::abs(trace) + length;
      const bool definite = h00 > 1e-3 * scale && minor > 1e-6 * scale * scale && det > 1e-9 * scale * scale * scale;
      const double newton = definite ? 1.0 / det : 0.0;
      const double gradient = definite ? 0.0 : 1.0 / (scale + 1e-30);
      const double w0 = newton * ((c00 * a0 + c01 * a1) + c02 * a2) + gradient * a0;
      const double w1 = newton * ((c01 * a0 + c11 * a1) + c12 * a2) + gradient * a1;
      const double w2 = newton * ((c02 * a0 + c12 * a1) + minor * a2) + gradient * a2;
      // The half angle as the vector part; at most about 53 degrees a step.
      const double size = std::sqrt((w0 * w0 + w1 * w1) + w2 * w2);
      const double bound = size > 1.0 ? 0.5 / size : 0.5;
      const double ex = bound * w0;
      const double ey = bound * w1;
      const double ez = bound * w2;
      // R <- R exp(w): the increment multiplies from the right.
      const double nw = ((w - qx * ex) - qy * ey) - qz * ez;
      const double nx = ((qx + w * ex) + qy * ez) - qz * ey;
      const double ny = ((qy + w * ey) + qz * ex) - qx * ez;
      const double nz = ((qz + w * ez) + qx * ey) - qy * ex;
      const double inverse = 1.0 / std::sqrt((nw * nw + nx * nx) + (ny * ny + nz * nz));
      w = nw * inverse;
      qx = nx * inverse;
      qy = ny * inverse;
      qz = nz * inverse;
    }
    q[0][l] = w;
    q[1][l] = qx;
    q[2][l] = qy;
    q[3][l] = qz;
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
      gather(groups_[g], position, x);
      rotate(x, groups_[g], sweeps, rotation[g]);
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
