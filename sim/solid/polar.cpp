// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/polar.h"

#include <cmath>

namespace calot {

CALOT_LANE_KERNEL void turnTowardsPolar(const DeformationLanes& f, int sweeps, RotationGroup& q) {
  for (std::size_t l = 0; l < laneCount; ++l) {
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
      const double b00 = (r00 * f[0][0][l] + r10 * f[1][0][l]) + r20 * f[2][0][l];
      const double b01 = (r00 * f[0][1][l] + r10 * f[1][1][l]) + r20 * f[2][1][l];
      const double b02 = (r00 * f[0][2][l] + r10 * f[1][2][l]) + r20 * f[2][2][l];
      const double b10 = (r01 * f[0][0][l] + r11 * f[1][0][l]) + r21 * f[2][0][l];
      const double b11 = (r01 * f[0][1][l] + r11 * f[1][1][l]) + r21 * f[2][1][l];
      const double b12 = (r01 * f[0][2][l] + r11 * f[1][2][l]) + r21 * f[2][2][l];
      const double b20 = (r02 * f[0][0][l] + r12 * f[1][0][l]) + r22 * f[2][0][l];
      const double b21 = (r02 * f[0][1][l] + r12 * f[1][1][l]) + r22 * f[2][1][l];
      const double b22 = (r02 * f[0][2][l] + r12 * f[1][2][l]) + r22 * f[2][2][l];
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

}  // namespace calot
