// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/stiffness_assembly.h"

#include <algorithm>

#include "sim/math/floating_point.h"

namespace calot {

namespace {

constexpr std::size_t groupsPerTask = 16;
constexpr std::size_t blocksPerTask = 1024;

}  // namespace

const std::vector<float>& StiffnessAssembly::update(const SolidModel& model, const SolidSystem& system,
                                                    std::span<const RotationGroup> rotation,
                                                    std::span<const double> fill, std::span<const double> mass,
                                                    const Scale& scale, Executor& executor) {
  if (scale != scale_) {
    scale_ = scale;
    made_.clear();
    values_.clear();
  }
  makeElements(model, rotation, fill, executor);
  if (values_.empty()) {
    values_.assign(system.matrix().valueCount(), 0.0F);
    stale_.assign(system.blocks().size(), 1);
  } else {
    for (std::size_t g = 0; g < changed_.size(); ++g) {
      for (std::size_t l = 0; l < laneCount; ++l) {
        const std::size_t e = g * laneCount + l;
        if ((changed_[g] >> l & 1U) == 0 || e >= model.elementCount()) continue;
        for (const std::uint32_t s : system.slotsAt(e)) stale_[s] = 1;
      }
    }
  }
  executor.run((stale_.size() + blocksPerTask - 1) / blocksPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t last = std::min(stale_.size(), (task + 1) * blocksPerTask);
    for (std::size_t s = task * blocksPerTask; s < last; ++s) {
      if (stale_[s] == 0) continue;
      stale_[s] = 0;
      const SolidSystem::Slot& slot = system.blocks()[s];
      Block block{};
      if (model.madeOfCubes()) {
        addCubes(system, slot, block);
      } else {
        addTetrahedra(model, system, slot, block);
      }
      if (slot.node >= 0) {
        const auto own = static_cast<float>(scale.mass * mass[static_cast<std::size_t>(slot.node)]);
        for (std::size_t i = 0; i < 3; ++i) block[4 * i] += own;
      }
      for (std::size_t k = 0; k < 9; ++k) values_[slot.place + k * laneCount] = block[k];
    }
  });
  return values_;
}

/// Blocks of elements that have turned by a grain, or whose fill has changed. How an empty cube turns does not matter.
void StiffnessAssembly::makeElements(const SolidModel& model, std::span<const RotationGroup> rotation,
                                     std::span<const double> fill, Executor& executor) {
  const bool first = made_.empty();
  made_.resize(model.groups());
  changed_.resize(model.groups());
  if (model.madeOfCubes()) {
    cube_.resize(model.groups() * laneCount);
  } else {
    gradient_.resize(model.groups());
  }
  executor.run((model.groups() + groupsPerTask - 1) / groupsPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t last = std::min(model.groups(), (task + 1) * groupsPerTask);
    for (std::size_t g = task * groupsPerTask; g < last; ++g) {
      Made now{};
      toGrain(rotation[g], scale_.grain, now.rotation);
      if (model.madeOfCubes()) now.fill = model.hexahedra().fillOf(g, fill);
      changed_[g] = 0;
      for (std::size_t l = 0; l < laneCount; ++l) {
        bool same = !first && now.fill[l] == made_[g].fill[l];
        const bool empty = model.madeOfCubes() && now.fill[l] == 0.0;
        for (std::size_t k = 0; k < 4; ++k) same = same && (empty || now.rotation[k][l] == made_[g].rotation[k][l]);
        if (!same) changed_[g] = static_cast<std::uint8_t>(changed_[g] | 1U << l);
      }
      if (changed_[g] == 0) continue;
      made_[g] = now;
      if (model.madeOfCubes()) {
        model.hexahedra().blocks(now.rotation, now.fill,
                                 std::span<HexahedronBlocks, laneCount>(cube_.data() + g * laneCount, laneCount));
      } else {
        model.elements().gradients(g, now.rotation, gradient_[g]);
      }
    }
  });
}

/// Adds K_ab of the tetrahedra at a block:
///   V (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) I).
void StiffnessAssembly::addTetrahedra(const SolidModel& model, const SolidSystem& system, const SolidSystem::Slot& slot,
                                      Block& block) const {
  const SolidModel::Material& m = model.material();
  const auto scale = static_cast<float>(scale_.stiffness);
  const float lambda = scale * static_cast<float>(m.lame.lambda);
  const float mu = scale * static_cast<float>(m.lame.mu);
  for (std::size_t c = slot.first; c < slot.last; ++c) {
    const SolidSystem::Contribution& contribution = system.contributions()[c];
    const auto e = static_cast<std::size_t>(contribution.element);
    const std::size_t l = e % laneCount;
    const RotatedGradients& gradient = gradient_[e / laneCount];
    const auto volume = static_cast<float>(model.elements().groups()[e / laneCount].volume[l]);
    float ga[3];
    float gb[3];
    for (std::size_t i = 0; i < 3; ++i) {
      ga[i] = gradient[contribution.a][i][l];
      gb[i] = gradient[contribution.b][i][l];
    }
    const float lv = lambda * volume;
    const float mv = mu * volume;
    const float diagonal = mv * ((ga[0] * gb[0] + ga[1] * gb[1]) + ga[2] * gb[2]);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) block[3 * i + j] += lv * (ga[i] * gb[j]) + mv * (gb[i] * ga[j]);
      block[4 * i] += diagonal;
    }
  }
}

void StiffnessAssembly::addCubes(const SolidSystem& system, const SolidSystem::Slot& slot, Block& block) const {
  const auto scale = static_cast<float>(scale_.stiffness);
  Block sum{};
  Block turned{};
  static_assert(sizeof(HexahedronBlocks) == 36 * sizeof(Block));
  const Block* block0 = cube_.front().data();  // of all cubes, one after the other
  const auto add = [&](std::size_t first, std::size_t last, Block& to) {
    for (std::size_t c = first; c < last; ++c) {
      const Block& from = block0[system.cubeBlocks()[c]];
      for (std::size_t k = 0; k < 9; ++k) to[k] += from[k];
    }
  };
  add(slot.first, slot.turned, sum);
  add(slot.turned, slot.last, turned);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) block[3 * i + j] = scale * (sum[3 * i + j] + turned[3 * j + i]);
  }
}

}  // namespace calot
