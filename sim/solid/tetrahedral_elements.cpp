// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/elements.h"

#include <algorithm>
#include <cmath>

#include "sim/math/floating_point.h"
#include "sim/math/vectors.h"

namespace calot {

namespace {

/// rotateTowardsPolar() of lanes `from` to `from` + 3.
CALOT_INLINE void rotateFour(const DeformationLanes& f, int sweeps, RotationGroup& q, std::size_t from) {
  FourDoubles m[3][3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) readVector(f[i][j].data() + from, m[i][j]);
  }
  FourDoubles w;
  FourDoubles qx;
  FourDoubles qy;
  FourDoubles qz;
  readVector(q[0].data() + from, w);
  readVector(q[1].data() + from, qx);
  readVector(q[2].data() + from, qy);
  readVector(q[3].data() + from, qz);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const FourDoubles none{};
    const FourDoubles r00 = 1.0 - 2.0 * (qy * qy + qz * qz);
    const FourDoubles r01 = 2.0 * (qx * qy - w * qz);
    const FourDoubles r02 = 2.0 * (qx * qz + w * qy);
    const FourDoubles r10 = 2.0 * (qx * qy + w * qz);
    const FourDoubles r11 = 1.0 - 2.0 * (qx * qx + qz * qz);
    const FourDoubles r12 = 2.0 * (qy * qz - w * qx);
    const FourDoubles r20 = 2.0 * (qx * qz - w * qy);
    const FourDoubles r21 = 2.0 * (qy * qz + w * qx);
    const FourDoubles r22 = 1.0 - 2.0 * (qx * qx + qy * qy);
    const FourDoubles b00 = (r00 * m[0][0] + r10 * m[1][0]) + r20 * m[2][0];
    const FourDoubles b01 = (r00 * m[0][1] + r10 * m[1][1]) + r20 * m[2][1];
    const FourDoubles b02 = (r00 * m[0][2] + r10 * m[1][2]) + r20 * m[2][2];
    const FourDoubles b10 = (r01 * m[0][0] + r11 * m[1][0]) + r21 * m[2][0];
    const FourDoubles b11 = (r01 * m[0][1] + r11 * m[1][1]) + r21 * m[2][1];
    const FourDoubles b12 = (r01 * m[0][2] + r11 * m[1][2]) + r21 * m[2][2];
    const FourDoubles b20 = (r02 * m[0][0] + r12 * m[1][0]) + r22 * m[2][0];
    const FourDoubles b21 = (r02 * m[0][1] + r12 * m[1][1]) + r22 * m[2][1];
    const FourDoubles b22 = (r02 * m[0][2] + r12 * m[1][2]) + r22 * m[2][2];
    const FourDoubles a0 = b21 - b12;
    const FourDoubles a1 = b02 - b20;
    const FourDoubles a2 = b10 - b01;
    const FourDoubles h00 = b11 + b22;
    const FourDoubles h11 = b00 + b22;
    const FourDoubles h22 = b00 + b11;
    const FourDoubles h01 = -0.5 * (b01 + b10);
    const FourDoubles h02 = -0.5 * (b02 + b20);
    const FourDoubles h12 = -0.5 * (b12 + b21);
    const FourDoubles c00 = h11 * h22 - h12 * h12;
    const FourDoubles c01 = h02 * h12 - h01 * h22;
    const FourDoubles c02 = h01 * h12 - h02 * h11;
    const FourDoubles minor = h00 * h11 - h01 * h01;
    const FourDoubles det = (h00 * c00 + h01 * c01) + h02 * c02;
    const FourDoubles c11 = h00 * h22 - h02 * h02;
    const FourDoubles c12 = h01 * h02 - h00 * h12;
    const FourDoubles trace = (b00 + b11) + b22;
    FourDoubles length = (a0 * a0 + a1 * a1) + a2 * a2;
    squareRoot(length);
    const FourDoubles scale = (trace < none ? -trace : trace) + length;
    const auto definite = (h00 > 1e-3 * scale) & (minor > 1e-6 * scale * scale) & (det > 1e-9 * scale * scale * scale);
    const FourDoubles newton = definite ? 1.0 / det : none;
    const FourDoubles gradient = definite ? none : 1.0 / (scale + 1e-30);
    const FourDoubles w0 = newton * ((c00 * a0 + c01 * a1) + c02 * a2) + gradient * a0;
    const FourDoubles w1 = newton * ((c01 * a0 + c11 * a1) + c12 * a2) + gradient * a1;
    const FourDoubles w2 = newton * ((c02 * a0 + c12 * a1) + minor * a2) + gradient * a2;
    // Half the angle as the vector part: at most about 53 degrees per step.
    FourDoubles size = (w0 * w0 + w1 * w1) + w2 * w2;
    squareRoot(size);
    const FourDoubles bound = size > 1.0 ? 0.5 / size : none + 0.5;
    const FourDoubles ex = bound * w0;
    const FourDoubles ey = bound * w1;
    const FourDoubles ez = bound * w2;
    // R <- R exp(w): the increment multiplies from the right.
    const FourDoubles nw = ((w - qx * ex) - qy * ey) - qz * ez;
    const FourDoubles nx = ((qx + w * ex) + qy * ez) - qz * ey;
    const FourDoubles ny = ((qy + w * ey) + qz * ex) - qx * ez;
    const FourDoubles nz = ((qz + w * ez) + qx * ey) - qy * ex;
    FourDoubles norm = (nw * nw + nx * nx) + (ny * ny + nz * nz);
    squareRoot(norm);
    const FourDoubles inverse = 1.0 / norm;
    w = nw * inverse;
    qx = nx * inverse;
    qy = ny * inverse;
    qz = nz * inverse;
  }
  writeVector(w, q[0].data() + from);
  writeVector(qx, q[1].data() + from);
  writeVector(qy, q[2].data() + from);
  writeVector(qz, q[3].data() + from);
}

}  // namespace

CALOT_LANE_KERNEL void rotateTowardsPolar(const DeformationLanes& f, int sweeps, RotationGroup& q) {
  rotateFour(f, sweeps, q, 0);
  rotateFour(f, sweeps, q, 4);
}

namespace {

constexpr std::size_t elementGroupsPerTask = 16;
/// Least determinant of tr(U) I - U, 8 at rest: flatter elements keep no moments. Numerical.
constexpr double minTurn = 1.0;

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

/// F = sum_a x_a grad_a^T of lanes `from` to `from` + 3.
CALOT_INLINE void deformationOf(const NodeLanes& x, const ElementGroup& group, std::size_t from,
                                FourDoubles (&f)[3][3]) {
  FourDoubles at[4];
  FourDoubles slope[4];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t a = 0; a < 4; ++a) readVector(x[a][i].data() + from, at[a]);
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t a = 0; a < 4; ++a) readVector(group.gradient[a][j].data() + from, slope[a]);
      f[i][j] = ((at[0] * slope[0] + at[1] * slope[1]) + at[2] * slope[2]) + at[3] * slope[3];
    }
  }
}

CALOT_LANE_KERNEL void deformation(const NodeLanes& x, const ElementGroup& group, DeformationLanes& f) {
  for (std::size_t from = 0; from < laneCount; from += 4) {
    FourDoubles part[3][3];
    deformationOf(x, group, from, part);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) writeVector(part[i][j], f[i][j].data() + from);
    }
  }
}

/// sigma + sigma_0 + Omega in place of sigma, where Omega U + U Omega = U sigma_0 - sigma_0 U (Omega is skew: with
/// Omega = [w]x and the right side [k]x, (tr(U) I - U) w = k).
/// @param e U - I: xx, yy, zz, xy, xz, yz
CALOT_INLINE void addInitial(const InitialStress& initial, const FourDoubles (&e)[6], std::size_t from,
                             FourDoubles (&s)[3][3]) {
  FourDoubles t[6];
  for (std::size_t k = 0; k < 6; ++k) readVector(initial[k].data() + from, t[k]);
  const FourDoubles k0 = (e[4] * t[3] + e[5] * t[1] + e[2] * t[5]) - (e[3] * t[4] + e[1] * t[5] + e[5] * t[2]);
  const FourDoubles k1 = (e[0] * t[4] + e[3] * t[5] + e[4] * t[2]) - (e[4] * t[0] + e[5] * t[3] + e[2] * t[4]);
  const FourDoubles k2 = (e[3] * t[0] + e[1] * t[3] + e[5] * t[4]) - (e[0] * t[3] + e[3] * t[1] + e[4] * t[5]);
  const FourDoubles g00 = (2.0 + e[1]) + e[2];
  const FourDoubles g11 = (2.0 + e[0]) + e[2];
  const FourDoubles g22 = (2.0 + e[0]) + e[1];
  const FourDoubles c00 = g11 * g22 - e[5] * e[5];
  const FourDoubles c11 = g00 * g22 - e[4] * e[4];
  const FourDoubles c22 = g00 * g11 - e[3] * e[3];
  const FourDoubles c01 = e[3] * g22 + e[4] * e[5];
  const FourDoubles c02 = e[4] * g11 + e[3] * e[5];
  const FourDoubles c12 = e[5] * g00 + e[3] * e[4];
  FourDoubles determinant = (g00 * c00 - e[3] * c01) - e[4] * c02;
  const FourDoubles least = FourDoubles{} + minTurn;
  determinant = determinant > least ? determinant : least;
  const FourDoubles w0 = ((c00 * k0 + c01 * k1) + c02 * k2) / determinant;
  const FourDoubles w1 = ((c01 * k0 + c11 * k1) + c12 * k2) / determinant;
  const FourDoubles w2 = ((c02 * k0 + c12 * k1) + c22 * k2) / determinant;
  for (std::size_t i = 0; i < 3; ++i) s[i][i] += t[i];
  s[0][1] += t[3] - w2;
  s[1][0] += t[3] + w2;
  s[0][2] += t[4] + w1;
  s[2][0] += t[4] - w1;
  s[1][2] += t[5] - w0;
  s[2][1] += t[5] + w0;
}

/// @param initial stress at rest, or null: none
CALOT_INLINE void forcesOf(const NodeLanes& x, const ElementGroup& group, LameConstants material,
                           const InitialStress* initial, const RotationGroup& q, std::size_t from, ElementResult& out) {
  const double lambda = material.lambda;
  const double mu = material.mu;
  FourDoubles w;
  FourDoubles qx;
  FourDoubles qy;
  FourDoubles qz;
  readVector(q[0].data() + from, w);
  readVector(q[1].data() + from, qx);
  readVector(q[2].data() + from, qy);
  readVector(q[3].data() + from, qz);
  const FourDoubles r[3][3] = {{1.0 - 2.0 * (qy * qy + qz * qz), 2.0 * (qx * qy - w * qz), 2.0 * (qx * qz + w * qy)},
                               {2.0 * (qx * qy + w * qz), 1.0 - 2.0 * (qx * qx + qz * qz), 2.0 * (qy * qz - w * qx)},
                               {2.0 * (qx * qz - w * qy), 2.0 * (qy * qz + w * qx), 1.0 - 2.0 * (qx * qx + qy * qy)}};
  FourDoubles f[3][3];
  deformationOf(x, group, from, f);
  FourDoubles b[3][3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) b[i][j] = (r[0][i] * f[0][j] + r[1][i] * f[1][j]) + r[2][i] * f[2][j];
  }
  const FourDoubles e00 = b[0][0] - 1.0;
  const FourDoubles e11 = b[1][1] - 1.0;
  const FourDoubles e22 = b[2][2] - 1.0;
  const FourDoubles trace = lambda * ((e00 + e11) + e22);
  FourDoubles s[3][3];
  s[0][0] = 2.0 * mu * e00 + trace;
  s[1][1] = 2.0 * mu * e11 + trace;
  s[2][2] = 2.0 * mu * e22 + trace;
  s[0][1] = s[1][0] = mu * (b[0][1] + b[1][0]);
  s[0][2] = s[2][0] = mu * (b[0][2] + b[2][0]);
  s[1][2] = s[2][1] = mu * (b[1][2] + b[2][1]);
  if (initial != nullptr) {
    const FourDoubles e[6] = {
        e00, e11, e22, 0.5 * (b[0][1] + b[1][0]), 0.5 * (b[0][2] + b[2][0]), 0.5 * (b[1][2] + b[2][1])};
    addInitial(*initial, e, from, s);
  }
  FourDoubles volume;
  readVector(group.volume.data() + from, volume);
  FourDoubles p[3][3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) p[i][j] = (r[i][0] * s[0][j] + r[i][1] * s[1][j]) + r[i][2] * s[2][j];
  }
  for (std::size_t a = 0; a < 4; ++a) {
    FourDoubles g[3];
    for (std::size_t j = 0; j < 3; ++j) readVector(group.gradient[a][j].data() + from, g[j]);
    for (std::size_t i = 0; i < 3; ++i) {
      const FourDoubles force = -volume * ((p[i][0] * g[0] + p[i][1] * g[1]) + p[i][2] * g[2]);
      writeVector(force, out.force[a][i].data() + from);
    }
  }
}

CALOT_LANE_KERNEL void forces(const NodeLanes& x, const ElementGroup& group, LameConstants material,
                              const InitialStress* initial, const RotationGroup& q, ElementResult& out) {
  forcesOf(x, group, material, initial, q, 0, out);
  forcesOf(x, group, material, initial, q, 4, out);
}

CALOT_LANE_KERNEL void rotated(const ElementGroup& group, const RotationGroup& q, RotatedGradients& out) {
  for (std::size_t l = 0; l < laneCount; ++l) {
    const double w = q[0][l];
    const double x = q[1][l];
    const double y = q[2][l];
    const double z = q[3][l];
    const double r[3][3] = {{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
                            {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
                            {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}};
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t i = 0; i < 3; ++i) {
        out[a][i][l] = static_cast<float>((r[i][0] * group.gradient[a][0][l] + r[i][1] * group.gradient[a][1][l]) +
                                          r[i][2] * group.gradient[a][2][l]);
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
  const std::size_t tasks = (groups_.size() + elementGroupsPerTask - 1) / elementGroupsPerTask;
  executor.run(tasks, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t end = std::min(groups_.size(), (task + 1) * elementGroupsPerTask);
    for (std::size_t g = task * elementGroupsPerTask; g < end; ++g) {
      NodeLanes x;
      NodeLanes v;
      DeformationLanes f;
      gather(groups_[g], position, x);
      deformation(x, groups_[g], f);
      rotateTowardsPolar(f, sweeps, rotation[g]);
      gather(groups_[g], velocity, v);
      for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t l = 0; l < laneCount; ++l) x[a][i][l] += lookAhead * v[a][i][l];
        }
      }
      forces(x, groups_[g], material, stress_.empty() ? nullptr : &stress_[g], rotation[g], result[g]);
    }
  });
}

void TetrahedralElements::preload(std::span<const Vec3> displacement, LameConstants material) {
  stress_.assign(groups_.size(), {});
  for (std::size_t e = 0; e < count_; ++e) {
    const ElementGroup& group = groups_[e / laneCount];
    const std::size_t l = e % laneCount;
    Mat3 slope = Mat3::Zero();
    for (std::size_t a = 0; a < 4; ++a) {
      const Vec3 gradient(group.gradient[a][0][l], group.gradient[a][1][l], group.gradient[a][2][l]);
      slope += displacement[static_cast<std::size_t>(group.node[a][l])] * gradient.transpose();
    }
    const Mat3 stress =
        material.mu * (slope + slope.transpose()) + (material.lambda * slope.trace()) * Mat3::Identity();
    InitialStress& out = stress_[e / laneCount];
    for (int i = 0; i < 3; ++i) out[static_cast<std::size_t>(i)][l] = stress(i, i);
    out[3][l] = stress(0, 1);
    out[4][l] = stress(0, 2);
    out[5][l] = stress(1, 2);
  }
}

void TetrahedralElements::gradients(std::size_t group, const RotationGroup& rotation, RotatedGradients& out) const {
  rotated(groups_[group], rotation, out);
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
