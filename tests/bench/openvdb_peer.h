// SPDX-License-Identifier: GPL-3.0-or-later
// OpenVDB as a peer of the closest point transform; built where libopenvdb-dev is there (CALOT_OPENVDB).
#pragma once

#include "sim/geometry/triangle_mesh.h"

namespace calot::bench {

/// OpenVDB's signed distance field of a surface, made on one thread.
struct OpenvdbField {
  double seconds = 0.0;        ///< CPU time of the thread
  long long activeVoxels = 0;  ///< in the band
  double maxError = 0.0;       ///< against `value`, in cells
};

/// @param cell m @param band cells, inside and outside
/// @param distance the exact field at a point given in cells from the origin, for the error; asked at some voxels
OpenvdbField openvdbField(const TriangleMesh& mesh, const Vec3& origin, double cell, double band,
                          double (*distance)(const void* context, const Index3& node), const void* context);

}  // namespace calot::bench
