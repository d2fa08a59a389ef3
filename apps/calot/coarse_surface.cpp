// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/coarse_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/mesh_to_count.h"

namespace calot::apps {
namespace {

/// Of the number that was asked for.
constexpr double goodEnough = 0.1, acceptable = 0.3;
constexpr int searches = 8;

}  // namespace

CoarseSurface coarseSurface(const TriangleMesh& surface, int triangles) {
  CoarseSurface best;
  if (triangles >= surface.triangles()) {
    best.error = fmt::format("the surface has {} triangles; --surface-triangles makes it coarser, not finer",
                             surface.triangles());
    return best;
  }
  double wanted = std::clamp(0.3 * triangles, 12.0, static_cast<double>(maxTetrahedronCount));
  double least = acceptable;
  std::string fault;
  for (int i = 0; i < searches; ++i) {
    StuffedMesh stuffed = stuffToCount(surface, static_cast<int>(std::lround(wanted)));
    if (!stuffed.ok()) {
      fault = stuffed.error;
      wanted *= 1.5;
    } else {
      TriangleMesh boundary = boundarySurface(stuffed.mesh);
      const double ratio = static_cast<double>(boundary.triangles()) / triangles;
      if (const double error = std::abs(ratio - 1.0); error < least) {
        least = error;
        best.mesh = std::move(boundary);
      }
      if (least <= goodEnough) break;
      wanted *= std::pow(ratio, -1.5);  // area grows as the number of cells to the power of 2/3
    }
    wanted = std::clamp(wanted, 12.0, static_cast<double>(maxTetrahedronCount));
  }
  if (best.mesh.triangle.empty()) {
    best.error = fmt::format("no closed surface of about {} triangles was found{}", triangles,
                             fault.empty() ? "" : ": " + fault);
  }
  return best;
}

}  // namespace calot::apps
