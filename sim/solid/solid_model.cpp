// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/solid/solid_model.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

#include "sim/math/floating_point.h"
#include "sim/math/vectors.h"
#include "sim/solid/block_matrix.h"

namespace calot {

SolidModel::SolidModel(std::vector<Vec3> rest, std::vector<Index4> tetrahedra, const std::vector<bool>& fixed,
                       Material material)
    : rest_(std::move(rest)),
      tetrahedra_(std::move(tetrahedra)),
      material_(material),
      elements_(TetrahedralElements(rest_, tetrahedra_)),
      system_({tetrahedra_, {}}, fixed) {
  mass_.assign(rest_.size(), 0.0);
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    const double quarter = 0.25 * material_.density * elements().restVolume(e);
    for (int a = 0; a < 4; ++a) mass_[static_cast<std::size_t>(tetrahedra_[e][a])] += quarter;
  }
  wholeMass_ = std::accumulate(mass_.begin(), mass_.end(), 0.0);
}

SolidModel::SolidModel(std::vector<Vec3> rest, std::vector<Index8> cubes, double edge, const std::vector<bool>& fixed,
                       Material material)
    : rest_(std::move(rest)),
      cube_(std::move(cubes)),
      material_(material),
      elements_(HexahedralElements(cube_, edge, material_.lame)),
      system_({{}, cube_}, fixed) {
  mass_.assign(rest_.size(), 0.0);
  const double eighth = 0.125 * material_.density * (edge * edge * edge);
  for (const Index8& cube : cube_) {
    for (const int node : cube) mass_[static_cast<std::size_t>(node)] += eighth;
  }
  wholeMass_ = std::accumulate(mass_.begin(), mass_.end(), 0.0);
}

std::size_t SolidModel::groups() const { return laneGroups(elementCount()); }

double SolidModel::volume(std::span<const Vec3> position, std::span<const double> fill) const {
  return madeOfCubes() ? hexahedra().volume(position, fill) : elements().volume(position);
}

Mat3 rotationOf(std::span<const RotationGroup> rotation, int element) {
  const auto e = static_cast<std::size_t>(element);
  const RotationGroup& group = rotation[e / laneCount];
  const std::size_t l = e % laneCount;
  return Quat(group[0][l], group[1][l], group[2][l], group[3][l]).toRotationMatrix();
}

SolidState restState(const SolidModel& model) {
  SolidState state;
  state.position = model.rest();
  state.velocity.assign(model.nodes(), Vec3::Zero());
  RotationGroup identity{};
  identity[0].fill(1.0);
  state.rotation.assign(model.groups(), identity);
  state.quietSteps = 1U << 20U;
  state.volume = model.volume(state.position);
  return state;
}

void SolidModel::massOf(std::span<const double> fill, std::vector<double>& mass) const {
  mass.assign(rest_.size(), 0.0);
  const double edge = hexahedra().edge();
  const double eighth = 0.125 * material_.density * (edge * edge * edge);
  for (std::size_t e = 0; e < cube_.size(); ++e) {
    for (const int node : cube_[e]) mass[static_cast<std::size_t>(node)] += fill[e] * eighth;
  }
}

void SolidModel::preload(std::span<const Vec3> displacement) {
  if (madeOfCubes()) {
    std::get<HexahedralElements>(elements_).preload(displacement);
  } else {
    std::get<TetrahedralElements>(elements_).preload(displacement, material_.lame);
  }
}

std::vector<std::int32_t> SolidModel::elementsAt(std::size_t node) const {
  std::vector<std::int32_t> out;
  for (const SolidSystem::Contribution& corner : system_.incident(node)) out.push_back(corner.element);
  return out;
}

namespace {

constexpr std::size_t assembledGroupsPerTask = 16;
constexpr std::size_t columnsPerTask = 192;

using Block = std::array<float, 9>;

/// Sums of blocks of cubes, block columns of slices. @param which as SolidSystem::sources()
CALOT_LANE_KERNEL void cubeColumns(const Block* block, std::span<const SolidSystem::Column> columns,
                                   const std::uint32_t* which, float scale, float* values) {
  for (const SolidSystem::Column& column : columns) {
    EightFloats lane[laneCount];
    float last[laneCount];
    for (std::size_t l = 0; l < laneCount; ++l) {
      // One sum for blocks as stored, one for transposed blocks. Each block adds zero to the other sum, which is exact:
      // a sum that starts at zero is never -0.
      EightFloats sum[2] = {};
      FourFloats sumLast{};
      const std::uint32_t* source = which + column.first + l;
      for (std::size_t c = 0; c < column.count; ++c, source += laneCount) {
        const float* from = block[*source >> 1U].data();
        const std::int32_t transposed = -static_cast<std::int32_t>(*source & 1U);
        const EightInts mask = {transposed, transposed, transposed, transposed,
                                transposed, transposed, transposed, transposed};
        EightInts own;
        readVector(from, own);
        sum[0] += reinterpret_cast<EightFloats>(own & ~mask);
        sum[1] += reinterpret_cast<EightFloats>(own & mask);
        FourInts ends = {0, 0, 0, 0};
        std::memcpy(&ends, from + 8, sizeof(float));
        ends = __builtin_shufflevector(ends, ends, 0, 0, 0, 0) & FourInts{~transposed, transposed, 0, 0};
        sumLast += reinterpret_cast<FourFloats>(ends);
      }
      lane[l] = scale * (sum[0] + __builtin_shufflevector(sum[1], sum[1], 0, 3, 6, 1, 4, 7, 2, 5));
      last[l] = scale * (sumLast[0] + sumLast[1]);
    }
    transpose(lane);
    float* out = values + column.offset;
    for (std::size_t k = 0; k < laneCount; ++k) writeVector(lane[k], out + k * laneCount);
    std::memcpy(out + 8 * laneCount, last, sizeof last);
  }
}

/// Numbers of a tetrahedron: of each corner the rotated gradient and the tetrahedron's volume.
constexpr std::size_t cornerStride = rowStride;
constexpr std::size_t elementStride = 4 * cornerStride;

/// Transposes a lane group to consecutive tetrahedra.
CALOT_LANE_KERNEL void byElements(const RotatedGradients& gradient, const double* volume, float* out) {
  FourDoubles exact[2];
  readVectors<2>(volume, exact);
  EightFloats lanes[4];
  rows::join(__builtin_convertvector(exact[0], FourFloats), __builtin_convertvector(exact[1], FourFloats), lanes[3]);
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t i = 0; i < 3; ++i) readVector(gradient[a][i].data(), lanes[i]);
    EightFloats row[4];
    rows::toRows(lanes, lanes[3], row);
    for (std::size_t l = 0; l < 4; ++l) {
      float* at = out + l * elementStride + a * cornerStride;
      writeVector(FourFloats(__builtin_shufflevector(row[l], row[l], 0, 1, 2, 3)), at);
      writeVector(FourFloats(__builtin_shufflevector(row[l], row[l], 4, 5, 6, 7)), at + 4 * elementStride);
    }
  }
}

/// Corners a and b of a tetrahedron. @param which 16 tetrahedron + 4 a + b
CALOT_INLINE void corners(const float* element, std::uint32_t which, FourFloats& a, FourFloats& b) {
  const float* own = element + static_cast<std::size_t>(which >> 4U) * elementStride;
  readVector(own + (which >> 2U & 3U) * cornerStride, a);
  readVector(own + (which & 3U) * cornerStride, b);
}

/// Sums of K_ab of tetrahedra: V (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) I), block columns of slices. Lanes l
/// and l + 4 go side by side.
/// @param element as byElements() @param which as SolidSystem::sources()
CALOT_LANE_KERNEL void tetrahedraColumns(const float* element, std::span<const SolidSystem::Column> columns,
                                         const std::uint32_t* which, float lambda, float mu, float* values) {
  constexpr EightInts onDiagonal[3] = {
      {-1, 0, 0, 0, -1, 0, 0, 0}, {0, -1, 0, 0, 0, -1, 0, 0}, {0, 0, -1, 0, 0, 0, -1, 0}};
  for (const SolidSystem::Column& column : columns) {
    float byRows[3][laneCount * rowStride];  // row i of each lane's block
    for (std::size_t l = 0; l < 4; ++l) {
      EightFloats block[3] = {};
      const std::uint32_t* source = which + column.first + l;
      for (std::size_t c = 0; c < column.count; ++c, source += laneCount) {
        FourFloats low[2];
        FourFloats high[2];
        corners(element, source[0], low[0], low[1]);
        corners(element, source[4], high[0], high[1]);
        EightFloats ga;
        EightFloats gb;
        rows::join(low[0], high[0], ga);
        rows::join(low[1], high[1], gb);
        const EightFloats volume = __builtin_shufflevector(ga, ga, 3, 3, 3, 3, 7, 7, 7, 7);
        const EightFloats lv = lambda * volume;
        const EightFloats mv = mu * volume;
        const EightFloats product = ga * gb;
        const EightFloats diagonal = mv * ((__builtin_shufflevector(product, product, 0, 0, 0, 0, 4, 4, 4, 4) +
                                            __builtin_shufflevector(product, product, 1, 1, 1, 1, 5, 5, 5, 5)) +
                                           __builtin_shufflevector(product, product, 2, 2, 2, 2, 6, 6, 6, 6));
        const EightFloats a[3] = {__builtin_shufflevector(ga, ga, 0, 0, 0, 0, 4, 4, 4, 4),
                                  __builtin_shufflevector(ga, ga, 1, 1, 1, 1, 5, 5, 5, 5),
                                  __builtin_shufflevector(ga, ga, 2, 2, 2, 2, 6, 6, 6, 6)};
        const EightFloats b[3] = {__builtin_shufflevector(gb, gb, 0, 0, 0, 0, 4, 4, 4, 4),
                                  __builtin_shufflevector(gb, gb, 1, 1, 1, 1, 5, 5, 5, 5),
                                  __builtin_shufflevector(gb, gb, 2, 2, 2, 2, 6, 6, 6, 6)};
        for (std::size_t i = 0; i < 3; ++i) {
          block[i] += lv * (a[i] * gb) + mv * (b[i] * ga);
          // Adds zero elsewhere, which is exact: a sum that starts at zero is never -0.
          block[i] += reinterpret_cast<EightFloats>(reinterpret_cast<EightInts>(diagonal) & onDiagonal[i]);
        }
      }
      for (std::size_t i = 0; i < 3; ++i) {
        writeVector(FourFloats(__builtin_shufflevector(block[i], block[i], 0, 1, 2, 3)), byRows[i] + l * rowStride);
        writeVector(FourFloats(__builtin_shufflevector(block[i], block[i], 4, 5, 6, 7)),
                    byRows[i] + (l + 4) * rowStride);
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      EightFloats entry[3];
      rows::lanesOf(byRows[i], entry);
      for (std::size_t j = 0; j < 3; ++j) writeVector(entry[j], values + column.offset + (3 * i + j) * laneCount);
    }
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
    float* diagonal = values.data() + system.ofRow(row).back().offset;
    for (std::size_t i = 0; i < 3; ++i) diagonal[4 * i * laneCount] += own;
  }
}

void StiffnessAssembly::assembleCubes(const SolidModel& model, const SolidSystem& system,
                                      std::span<const RotationGroup> rotation, std::span<const double> fill,
                                      float scale, Executor& executor, std::vector<float>& values) {
  cube_.resize(model.groups() * laneCount + 1);
  cube_.back() = HexahedronBlocks{};  // SolidSystem::noElement()
  executor.run((model.groups() + assembledGroupsPerTask - 1) / assembledGroupsPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t last = std::min(model.groups(), (task + 1) * assembledGroupsPerTask);
    for (std::size_t g = task * assembledGroupsPerTask; g < last; ++g) {
      const std::array<double, laneCount> share = model.hexahedra().fillOf(g, fill);
      if (std::all_of(share.begin(), share.end(), [](double f) { return f == 0.0; })) continue;
      model.hexahedra().blocks(rotation[g], share,
                               std::span<HexahedronBlocks, laneCount>(cube_.data() + g * laneCount, laneCount));
    }
  });
  static_assert(sizeof(HexahedronBlocks) == 36 * sizeof(Block));
  const std::span<const SolidSystem::Column> columns = system.columns();
  executor.run((columns.size() + columnsPerTask - 1) / columnsPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const Block* block = cube_.front().data();  // of all cubes, one after the other
    const std::size_t first = task * columnsPerTask;
    const std::size_t count = std::min(columns.size() - first, columnsPerTask);
    cubeColumns(block, columns.subspan(first, count), system.sources().data(), scale, values.data());
  });
}

void StiffnessAssembly::assembleTetrahedra(const SolidModel& model, const SolidSystem& system,
                                           std::span<const RotationGroup> rotation, float scale, Executor& executor,
                                           std::vector<float>& values) {
  tetrahedron_.resize((model.groups() * laneCount + 1) * elementStride);
  std::fill(tetrahedron_.end() - elementStride, tetrahedron_.end(), 0.0F);  // SolidSystem::noElement()
  const float lambda = scale * static_cast<float>(model.material().lame.lambda);
  const float mu = scale * static_cast<float>(model.material().lame.mu);
  executor.run((model.groups() + assembledGroupsPerTask - 1) / assembledGroupsPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    RotatedGradients gradient;
    const std::size_t last = std::min(model.groups(), (task + 1) * assembledGroupsPerTask);
    for (std::size_t g = task * assembledGroupsPerTask; g < last; ++g) {
      model.elements().gradients(g, rotation[g], gradient);
      byElements(gradient, model.elements().groups()[g].volume.data(),
                 tetrahedron_.data() + g * laneCount * elementStride);
    }
  });
  const std::span<const SolidSystem::Column> columns = system.columns();
  executor.run((columns.size() + columnsPerTask - 1) / columnsPerTask, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t first = task * columnsPerTask;
    const std::size_t count = std::min(columns.size() - first, columnsPerTask);
    tetrahedraColumns(tetrahedron_.data(), columns.subspan(first, count), system.sources().data(), lambda, mu,
                      values.data());
  });
}

}  // namespace calot
