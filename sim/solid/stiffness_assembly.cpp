// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/stiffness_assembly.h"

#include <algorithm>

#include "sim/math/floating_point.h"
#include "sim/math/vectors.h"

namespace calot {

namespace {

constexpr std::size_t groupsPerTask = 16;
constexpr std::size_t slicesPerTask = 16;
constexpr std::size_t columnsPerTask = 192;

using Block = std::array<float, 9>;

/// One block column of a slice. @param which as SolidSystem::cubeBlocks(), of the column
CALOT_LANE_KERNEL void cubeColumn(const Block* block, const std::uint32_t* which, std::size_t count, float scale,
                                  float* out) {
  EightFloats lane[laneCount];
  float last[laneCount];
  for (std::size_t l = 0; l < laneCount; ++l) {
    EightFloats sum[2] = {};  // of the blocks as they are, and of those that are transposed
    float sumLast[2] = {};
    for (std::size_t c = 0; c < count; ++c) {
      const std::uint32_t w = which[c * laneCount + l];
      const float* from = block[w >> 1U].data();
      EightFloats own;
      readVector(from, own);
      sum[w & 1U] += own;
      sumLast[w & 1U] += from[8];
    }
    lane[l] = scale * (sum[0] + __builtin_shufflevector(sum[1], sum[1], 0, 3, 6, 1, 4, 7, 2, 5));
    last[l] = scale * (sumLast[0] + sumLast[1]);
  }
  transpose(lane);
  for (std::size_t k = 0; k < laneCount; ++k) writeVector(lane[k], out + k * laneCount);
  std::memcpy(out + 8 * laneCount, last, sizeof last);
}

/// Adds K_ab of a tetrahedron: V (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) I).
/// @param lv, mv lambda and mu times V
void addTetrahedron(const RotatedGradients& gradient, std::size_t l, std::size_t a, std::size_t b, float lv, float mv,
                    Block& block) {
  const float ga[3] = {gradient[a][0][l], gradient[a][1][l], gradient[a][2][l]};
  const float gb[3] = {gradient[b][0][l], gradient[b][1][l], gradient[b][2][l]};
  const float diagonal = mv * ((ga[0] * gb[0] + ga[1] * gb[1]) + ga[2] * gb[2]);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) block[3 * i + j] += lv * (ga[i] * gb[j]) + mv * (gb[i] * ga[j]);
    block[4 * i] += diagonal;
  }
}

}  // namespace

void StiffnessAssembly::assemble(const SolidModel& model, const SolidSystem& system,
                                 std::span<const RotationGroup> rotation, std::span<const double> fill,
                                 std::span<const double> mass, const Scale& scale, Executor& executor,
                                 std::vector<float>& values) {
  values.resize(system.matrix().valueCount());
  const auto stiffness = static_cast<float>(scale.stiffness);
  if (model.madeOfCubes()) {
    assembleCubes(model, system, rotation, fill, stiffness, executor, values);
  } else {
    assembleTetrahedra(model, system, rotation, stiffness, executor, values);
  }
  for (const int node : system.nodes()) {
    const auto row = static_cast<std::size_t>(system.row(static_cast<std::size_t>(node)));
    const auto own = static_cast<float>(scale.mass * mass[static_cast<std::size_t>(node)]);
    float* diagonal = values.data() + system.ofRow(row).back().place;
    for (std::size_t i = 0; i < 3; ++i) diagonal[4 * i * laneCount] += own;
  }
}

void StiffnessAssembly::assembleCubes(const SolidModel& model, const SolidSystem& system,
                                      std::span<const RotationGroup> rotation, std::span<const double> fill,
                                      float scale, Executor& executor, std::vector<float>& values) {
  cube_.resize(model.groups() * laneCount + 1);
  cube_.back() = HexahedronBlocks{};  // SolidSystem::noBlock()
  executor.run((model.groups() + groupsPerTask - 1) / groupsPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t last = std::min(model.groups(), (task + 1) * groupsPerTask);
    for (std::size_t g = task * groupsPerTask; g < last; ++g) {
      const std::array<double, laneCount> share = model.hexahedra().fillOf(g, fill);
      if (std::all_of(share.begin(), share.end(), [](double f) { return f == 0.0; })) continue;
      model.hexahedra().blocks(rotation[g], share,
                               std::span<HexahedronBlocks, laneCount>(cube_.data() + g * laneCount, laneCount));
    }
  });
  static_assert(sizeof(HexahedronBlocks) == 36 * sizeof(Block));
  const std::vector<SolidSystem::CubeColumn>& columns = system.cubeColumns();
  executor.run((columns.size() + columnsPerTask - 1) / columnsPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const Block* block = cube_.front().data();  // of all cubes, one after the other
    const std::size_t last = std::min(columns.size(), (task + 1) * columnsPerTask);
    for (std::size_t c = task * columnsPerTask; c < last; ++c) {
      const SolidSystem::CubeColumn& column = columns[c];
      cubeColumn(block, system.cubeBlocks().data() + column.first, column.count, scale, values.data() + column.place);
    }
  });
}

void StiffnessAssembly::assembleTetrahedra(const SolidModel& model, const SolidSystem& system,
                                           std::span<const RotationGroup> rotation, float scale, Executor& executor,
                                           std::vector<float>& values) {
  gradient_.resize(model.groups());
  std::fill(values.begin(), values.end(), 0.0F);
  const float lambda = scale * static_cast<float>(model.material().lame.lambda);
  const float mu = scale * static_cast<float>(model.material().lame.mu);
  executor.run((model.groups() + groupsPerTask - 1) / groupsPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t last = std::min(model.groups(), (task + 1) * groupsPerTask);
    for (std::size_t g = task * groupsPerTask; g < last; ++g) model.elements().gradients(g, rotation[g], gradient_[g]);
  });
  executor.run((system.matrix().slices() + slicesPerTask - 1) / slicesPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t last = std::min(system.matrix().rows(), (task + 1) * slicesPerTask * laneCount);
    for (std::size_t r = task * slicesPerTask * laneCount; r < last; ++r) {
      for (const SolidSystem::Slot& slot : system.ofRow(r)) {
        Block block{};
        for (std::size_t c = slot.first; c < slot.last; ++c) {
          const SolidSystem::Contribution& from = system.contributions()[c];
          const auto e = static_cast<std::size_t>(from.element);
          const auto volume = static_cast<float>(model.elements().restVolume(e));
          addTetrahedron(gradient_[e / laneCount], e % laneCount, from.a, from.b, lambda * volume, mu * volume, block);
        }
        for (std::size_t k = 0; k < 9; ++k) values[slot.place + k * laneCount] = block[k];
      }
    }
  });
}

}  // namespace calot
