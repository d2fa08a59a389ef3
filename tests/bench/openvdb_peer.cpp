// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/openvdb_peer.h"

#ifdef CALOT_OPENVDB
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/bench/thread_clock.h"

namespace calot::bench {

OpenvdbField openvdbField(const TriangleMesh& mesh, const Vec3& origin, double cell, double band,
                          double (*distance)(const void* context, const Index3& node), const void* context) {
  openvdb::initialize();
  const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
  std::vector<openvdb::Vec3s> points;
  for (const Vec3& p : mesh.vertex) {
    const Vec3 q = (p - origin) / cell;
    points.emplace_back(static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2]));
  }
  std::vector<openvdb::Vec3I> triangles;
  for (const Index3& t : mesh.triangle) {
    triangles.emplace_back(static_cast<openvdb::Index32>(t[0]), static_cast<openvdb::Index32>(t[1]),
                           static_cast<openvdb::Index32>(t[2]));
  }
  const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
  const auto width = static_cast<float>(band);
  OpenvdbField field;
  const double start = threadSeconds();
  const auto grid = openvdb::tools::meshToSignedDistanceField<openvdb::FloatGrid>(
      *transform, points, triangles, std::vector<openvdb::Vec4I>(), width, width);
  field.seconds = threadSeconds() - start;
  field.activeVoxels = static_cast<long long>(grid->activeVoxelCount());
  for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
    const openvdb::Coord at = voxel.getCoord();
    const double truth = distance(context, Index3(at.x(), at.y(), at.z())) / cell;
    if (std::abs(truth) > band - 1.0) continue;
    field.maxError = std::max(field.maxError, std::abs(static_cast<double>(*voxel) - truth));
  }
  return field;
}

}  // namespace calot::bench
#endif
