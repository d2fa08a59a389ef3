// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/modules/module.h"

namespace calot::recorder {

TriangleMesh uniteSurfaces(const std::vector<TriangleMesh>& piece) {
  return apps::module<apps::SurfaceModule>().unite(piece);
}

}  // namespace calot::recorder
