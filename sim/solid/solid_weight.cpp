// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/solid/solid_weight.h"

#include <array>

namespace calot {

namespace {

void addBlock(std::span<const int> row, int a, int b, const Mat3& block, SymmetricBlocks& matrix) {
  const int i = row[static_cast<std::size_t>(a)];
  const int j = row[static_cast<std::size_t>(b)];
  if (i >= 0 && j >= 0) matrix.add(static_cast<std::size_t>(i), static_cast<std::size_t>(j), block);
}

/// K_ab = V (mu (g_a . g_b) I + mu g_b g_a^T + lambda g_a g_b^T)
void addTetrahedra(const SolidModel& model, double factor, std::span<const int> row, SymmetricBlocks& matrix) {
  const LameConstants m = model.material().lame;
  for (std::size_t e = 0; e < model.tetrahedra().size(); ++e) {
    const ElementGroup& group = model.elements().groups()[e / laneCount];
    const std::size_t l = e % laneCount;
    std::array<Vec3, 4> g;
    for (std::size_t a = 0; a < 4; ++a)
      g[a] = {group.gradient[a][0][l], group.gradient[a][1][l], group.gradient[a][2][l]};
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        Mat3 block = (m.mu * g[a].dot(g[b])) * Mat3::Identity();
        block += m.mu * (g[b] * g[a].transpose()) + m.lambda * (g[a] * g[b].transpose());
        addBlock(row, group.node[a][l], group.node[b][l], (factor * group.volume[l]) * block, matrix);
      }
    }
  }
}

void addCubes(const SolidModel& model, std::span<const double> fill, double factor, std::span<const int> row,
              SymmetricBlocks& matrix) {
  const auto& stiffness = model.hexahedra().stiffness();
  for (std::size_t e = 0; e < model.cubes().size(); ++e) {
    const Index8& cube = model.cubes()[e];
    const double share = fill.empty() ? factor : factor * fill[e];
    for (std::size_t a = 0; a < 8; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        Mat3 block;
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) {
            block(static_cast<int>(i), static_cast<int>(j)) = share * stiffness[3 * a + i][3 * b + j];
          }
        }
        addBlock(row, cube[a], cube[b], block, matrix);
      }
    }
  }
}

}  // namespace

void addStiffness(const SolidModel& model, std::span<const double> fill, double factor, std::span<const int> row,
                  SymmetricBlocks& matrix) {
  if (model.madeOfCubes()) {
    addCubes(model, fill, factor, row, matrix);
  } else {
    addTetrahedra(model, factor, row, matrix);
  }
}

void addSpring(const PlacedPoint& a, const PlacedPoint& b, double stiffness, SymmetricBlocks& matrix) {
  const std::array<const PlacedPoint*, 2> end{&a, &b};
  for (std::size_t p = 0; p < 2; ++p) {
    for (std::size_t q = 0; q <= p; ++q) {
      const MaterialPoint& from = end[p]->point;
      const MaterialPoint& to = end[q]->point;
      for (std::size_t k = 0; k < from.count; ++k) {
        const int i = end[p]->row[static_cast<std::size_t>(from.node[k])];
        if (i < 0) continue;
        for (std::size_t l = 0; l < to.count; ++l) {
          const int j = end[q]->row[static_cast<std::size_t>(to.node[l])];
          if (j < 0 || (p == q && l > k)) continue;
          const double share = (p == q ? stiffness : -stiffness) * (from.weight[k] * to.weight[l]);
          matrix.add(static_cast<std::size_t>(i), static_cast<std::size_t>(j), share * Mat3::Identity());
        }
      }
    }
  }
}

}  // namespace calot
