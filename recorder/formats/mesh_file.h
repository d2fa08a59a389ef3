// SPDX-License-Identifier: GPL-3.0-or-later
// Tetrahedral meshes for ParaView and others: VTK legacy format, version 3.0, ASCII, UNSTRUCTURED_GRID (Kitware, "VTK
// File Formats").
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recorder/formats/surface_bytes.h"
#include "sim/geometry/isosurface_stuffing.h"

namespace calot::recorder {

/// parseSurface() of a file. @throws Error (damaged)
TriangleMesh readSurface(const std::filesystem::path& path, LengthUnit unit, const SurfaceLimits& limits = {},
                         std::vector<std::string>* notes = nullptr);

/// The text of a VTK file, in metres. Coordinates are written so that they are read back bit for bit.
/// @param title one line, at most 255 characters (more is cut off)
std::string formatVtk(const TetrahedralMesh& mesh, const std::string& title);

}  // namespace calot::recorder
