// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/elements.h"

#include <algorithm>
#include <cmath>

#include "sim/math/floating_point.h"
#include "sim/math/vectors.h"

namespace calot {

namespace {

constexpr std::size_t cubeGroupsPerTask = 4;

using CornerLanes = std::array<std::array<std::array<double, laneCount>, 3>, 8>;
using Stiffness = std::array<std::array<double, 24>, 24>;
using RotationLanes = std::array<std::array<std::array<double, laneCount>, 3>, 3>;

/// -1 or +1: side of the centre on which corner c lies along an axis.
constexpr double side(std::size_t c, std::size_t axis) { return ((c >> axis) & 1U) != 0 ? 1.0 : -1.0; }

void gather(const HexahedronGroup& group, std::span<const Vec3> values, CornerLanes& out) {
  for (std::size_t a = 0; a < 8; ++a) {
    for (std::size_t l = 0; l < laneCount; ++l) {
      const Vec3& v = values[static_cast<std::size_t>(group.node[a][l])];
      for (std::size_t i = 0; i < 3; ++i) out[a][i][l] = v[static_cast<int>(i)];
    }
  }
}

/// Mean of F over the cube: sum_a x_a g_a^T with g_a = (+-1, +-1, +-1) / (4 edge).
CALOT_LANE_KERNEL void deformation(const CornerLanes& x, double edge, DeformationLanes& f) {
  const double g = 0.25 / edge;
  for (std::size_t from = 0; from < laneCount; from += 4) {
    for (std::size_t i = 0; i < 3; ++i) {
      FourDoubles at[8];
      for (std::size_t a = 0; a < 8; ++a) readVector(x[a][i].data() + from, at[a]);
      for (std::size_t j = 0; j < 3; ++j) {
        FourDoubles sum{};
        for (std::size_t a = 0; a < 8; ++a) sum += side(a, j) * at[a];
        sum = g * sum;
        writeVector(sum, f[i][j].data() + from);
      }
    }
  }
}

CALOT_LANE_KERNEL void matrices(const RotationGroup& q, RotationLanes& r) {
  for (std::size_t l = 0; l < laneCount; ++l) {
    const double w = q[0][l];
    const double x = q[1][l];
    const double y = q[2][l];
    const double z = q[3][l];
    r[0][0][l] = 1.0 - 2.0 * (y * y + z * z);
    r[0][1][l] = 2.0 * (x * y - w * z);
    r[0][2][l] = 2.0 * (x * z + w * y);
    r[1][0][l] = 2.0 * (x * y + w * z);
    r[1][1][l] = 1.0 - 2.0 * (x * x + z * z);
    r[1][2][l] = 2.0 * (y * z - w * x);
    r[2][0][l] = 2.0 * (x * z - w * y);
    r[2][1][l] = 2.0 * (y * z + w * x);
    r[2][2][l] = 1.0 - 2.0 * (x * x + y * y);
  }
}

constexpr InitialForces noForces{};

/// u = R^T (x - middle) - corner, then f = -fill R (K u + f_0), of lanes `from` to `from` + 3.
CALOT_INLINE void forcesOf(const CornerLanes& x, const std::array<Vec3, 8>& corner, const Stiffness& stiffness,
                           const InitialForces& initial, const RotationLanes& rotation,
                           const std::array<double, laneCount>& fill, std::size_t from, HexahedronResult& out) {
  FourDoubles r[3][3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) readVector(rotation[i][j].data() + from, r[i][j]);
  }
  FourDoubles middle[3];
  for (std::size_t i = 0; i < 3; ++i) {
    FourDoubles sum{};
    for (std::size_t a = 0; a < 8; ++a) {
      FourDoubles at;
      readVector(x[a][i].data() + from, at);
      sum += at;
    }
    middle[i] = 0.125 * sum;
  }
  FourDoubles u[24];
  for (std::size_t a = 0; a < 8; ++a) {
    FourDoubles d[3];
    for (std::size_t i = 0; i < 3; ++i) {
      readVector(x[a][i].data() + from, d[i]);
      d[i] -= middle[i];
    }
    for (std::size_t j = 0; j < 3; ++j) {
      u[3 * a + j] = ((r[0][j] * d[0] + r[1][j] * d[1]) + r[2][j] * d[2]) - corner[a][static_cast<int>(j)];
    }
  }
  FourDoubles share;
  readVector(fill.data() + from, share);
  for (std::size_t a = 0; a < 8; ++a) {
    FourDoubles p[3];
    for (std::size_t i = 0; i < 3; ++i) readVector(initial[3 * a + i].data() + from, p[i]);
    for (std::size_t k = 0; k < 24; ++k) {
      for (std::size_t i = 0; i < 3; ++i) p[i] += stiffness[3 * a + i][k] * u[k];
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const FourDoubles force = -share * ((r[i][0] * p[0] + r[i][1] * p[1]) + r[i][2] * p[2]);
      writeVector(force, out.force[a][i].data() + from);
    }
  }
}

CALOT_LANE_KERNEL void forces(const CornerLanes& x, const std::array<Vec3, 8>& corner, const Stiffness& stiffness,
                              const InitialForces& initial, const RotationLanes& r,
                              const std::array<double, laneCount>& fill, HexahedronResult& out) {
  forcesOf(x, corner, stiffness, initial, r, fill, 0, out);
  forcesOf(x, corner, stiffness, initial, r, fill, 4, out);
}

CALOT_LANE_KERNEL void rotateStiffness(const Stiffness& stiffness, const RotationLanes& r,
                                       const std::array<double, laneCount>& fill, HexahedronBlocks* out) {
  EightFloats rotation[3][3];
  EightFloats share;
  for (std::size_t l = 0; l < laneCount; ++l) share[l] = static_cast<float>(fill[l]);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t l = 0; l < laneCount; ++l) rotation[i][j][l] = static_cast<float>(r[i][j][l]);
    }
  }
  for (std::size_t a = 0; a < 8; ++a) {
    for (std::size_t b = a; b < 8; ++b) {
      EightFloats half[3][3];  // fill R K_ab
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          const auto k0 = static_cast<float>(stiffness[3 * a][3 * b + j]);
          const auto k1 = static_cast<float>(stiffness[3 * a + 1][3 * b + j]);
          const auto k2 = static_cast<float>(stiffness[3 * a + 2][3 * b + j]);
          half[i][j] = share * ((rotation[i][0] * k0 + rotation[i][1] * k1) + rotation[i][2] * k2);
        }
      }
      EightFloats block[9];
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          block[3 * i + j] = (half[i][0] * rotation[j][0] + half[i][1] * rotation[j][1]) + half[i][2] * rotation[j][2];
        }
      }
      EightFloats first[laneCount];
      for (std::size_t k = 0; k < laneCount; ++k) first[k] = block[k];
      transpose(first);
      for (std::size_t l = 0; l < laneCount; ++l) {
        float* to = out[l][HexahedralElements::pairOf(a, b)].data();
        writeVector(first[l], to);
        to[8] = block[8][l];
      }
    }
  }
}

/// K of a full cube: deviatoric part in full, volumetric part with the mean dilatation.
void integrate(double edge, LameConstants material, Stiffness& stiffness) {
  const double bulk = material.lambda + 2.0 / 3.0 * material.mu;
  const double volume = edge * edge * edge;
  const double abscissa = 1.0 / std::sqrt(3.0);
  for (std::size_t point = 0; point < 8; ++point) {
    std::array<Vec3, 8> g;
    for (std::size_t a = 0; a < 8; ++a) {
      for (std::size_t i = 0; i < 3; ++i) {
        double slope = side(a, i) * 0.25 / edge;
        for (std::size_t j = 0; j < 3; ++j) {
          if (j != i) slope *= 1.0 + side(a, j) * side(point, j) * abscissa;
        }
        g[a][static_cast<int>(i)] = slope;
      }
    }
    const double part = 0.125 * volume * material.mu;
    for (std::size_t a = 0; a < 8; ++a) {
      for (std::size_t b = 0; b < 8; ++b) {
        const double dot = g[a].dot(g[b]);
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) {
            const auto ii = static_cast<int>(i);
            const auto jj = static_cast<int>(j);
            double entry = g[b][ii] * g[a][jj] - 2.0 / 3.0 * (g[a][ii] * g[b][jj]);
            if (i == j) entry += dot;
            stiffness[3 * a + i][3 * b + j] += part * entry;
          }
        }
      }
    }
  }
  const double mean = 0.25 / edge;
  for (std::size_t a = 0; a < 8; ++a) {
    for (std::size_t b = 0; b < 8; ++b) {
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          stiffness[3 * a + i][3 * b + j] += bulk * volume * (mean * side(a, i)) * (mean * side(b, j));
        }
      }
    }
  }
}

}  // namespace

HexahedralElements::HexahedralElements(std::span<const Index8> cells, double edge, LameConstants material)
    : count_(cells.size()), edge_(edge), groups_(laneGroups(cells.size())) {
  for (std::size_t e = 0; e < groups_.size() * laneCount; ++e) {
    HexahedronGroup& group = groups_[e / laneCount];
    const Index8& cell = cells[std::min(e, count_ - 1)];
    for (std::size_t a = 0; a < 8; ++a) group.node[a][e % laneCount] = cell[a];
    group.weight[e % laneCount] = e < count_ ? 1.0 : 0.0;
  }
  for (std::size_t a = 0; a < 8; ++a) corner_[a] = 0.5 * edge * Vec3(side(a, 0), side(a, 1), side(a, 2));
  integrate(edge, material, stiffness_);
}

void HexahedralElements::preload(std::span<const Vec3> displacement) {
  force_.assign(groups_.size(), {});
  for (std::size_t e = 0; e < count_; ++e) {
    const HexahedronGroup& group = groups_[e / laneCount];
    const std::size_t l = e % laneCount;
    for (std::size_t k = 0; k < 24; ++k) {
      double sum = 0.0;
      for (std::size_t b = 0; b < 8; ++b) {
        const Vec3& u = displacement[static_cast<std::size_t>(group.node[b][l])];
        for (std::size_t j = 0; j < 3; ++j) sum += stiffness_[k][3 * b + j] * u[static_cast<int>(j)];
      }
      force_[e / laneCount][k][l] = sum;
    }
  }
}

std::array<double, laneCount> HexahedralElements::fillOf(std::size_t group, std::span<const double> fill) const {
  std::array<double, laneCount> out = groups_[group].weight;
  if (!fill.empty()) {
    for (std::size_t l = 0; l < laneCount; ++l) out[l] *= fill[std::min(group * laneCount + l, count_ - 1)];
  }
  return out;
}

void HexahedralElements::blocks(const RotationGroup& rotation, const std::array<double, laneCount>& fill,
                                std::span<HexahedronBlocks, laneCount> out) const {
  RotationLanes r;
  matrices(rotation, r);
  rotateStiffness(stiffness_, r, fill, out.data());
}

void HexahedralElements::evaluate(std::span<const Vec3> position, std::span<const Vec3> velocity, double lookAhead,
                                  int sweeps, std::span<const double> fill, std::span<RotationGroup> rotation,
                                  std::span<HexahedronResult> result, Executor& executor) const {
  executor.run((groups_.size() + cubeGroupsPerTask - 1) / cubeGroupsPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t end = std::min(groups_.size(), (task + 1) * cubeGroupsPerTask);
    for (std::size_t g = task * cubeGroupsPerTask; g < end; ++g) {
      const std::array<double, laneCount> share = fillOf(g, fill);
      if (std::all_of(share.begin(), share.end(), [](double f) { return f == 0.0; })) continue;
      CornerLanes x;
      CornerLanes v;
      DeformationLanes f;
      gather(groups_[g], position, x);
      deformation(x, edge_, f);
      rotateTowardsPolar(f, sweeps, rotation[g]);
      RotationLanes r;
      matrices(rotation[g], r);
      gather(groups_[g], velocity, v);
      for (std::size_t a = 0; a < 8; ++a) {
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t l = 0; l < laneCount; ++l) x[a][i][l] += lookAhead * v[a][i][l];
        }
      }
      forces(x, corner_, stiffness_, force_.empty() ? noForces : force_[g], r, share, result[g]);
    }
  });
}

double HexahedralElements::volume(std::span<const Vec3> position, std::span<const double> fill) const {
  // The Jacobian is at most quadratic along each axis, so two Gauss points per axis are exact.
  const double abscissa = 1.0 / std::sqrt(3.0);
  double total = 0.0;
  for (std::size_t e = 0; e < count_; ++e) {
    const HexahedronGroup& group = groups_[e / laneCount];
    const std::size_t l = e % laneCount;
    double sum = 0.0;
    for (std::size_t point = 0; point < 8; ++point) {
      Mat3 f = Mat3::Zero();
      for (std::size_t a = 0; a < 8; ++a) {
        const Vec3& p = position[static_cast<std::size_t>(group.node[a][l])];
        for (std::size_t i = 0; i < 3; ++i) {
          double slope = side(a, i) * 0.125;
          for (std::size_t j = 0; j < 3; ++j) {
            if (j != i) slope *= 1.0 + side(a, j) * side(point, j) * abscissa;
          }
          f.col(static_cast<int>(i)) += slope * p;
        }
      }
      sum += f.col(0).dot(f.col(1).cross(f.col(2)));
    }
    total += fill.empty() ? sum : fill[e] * sum;
  }
  return total;
}

}  // namespace calot
