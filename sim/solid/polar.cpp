// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/polar.h"

#include <cmath>

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

}  // namespace calot
