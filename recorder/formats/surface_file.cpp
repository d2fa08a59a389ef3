// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/surface_file.h"

#include "recorder/base/file_bytes.h"

namespace calot::recorder {

TriangleMesh readSurface(const std::filesystem::path& path, LengthUnit unit, const SurfaceLimits& limits) {
  return parseSurface(readFileBytes(path, path.string(), limits.bytes), path.string(), unit, limits);
}

}  // namespace calot::recorder
