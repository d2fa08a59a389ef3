// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "recorder/formats/surface_bytes.h"

namespace calot::recorder {

/// parseSurface() of a file. @throws Error (damaged)
TriangleMesh readSurface(const std::filesystem::path& path, LengthUnit unit, const SurfaceLimits& limits = {});

}  // namespace calot::recorder
