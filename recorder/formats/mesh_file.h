// SPDX-License-Identifier: GPL-3.0-or-later
// Tetrahedral meshes for ParaView and others: VTK legacy format, version 3.0, ASCII, UNSTRUCTURED_GRID (Kitware, "VTK
// File Formats").
#pragma once

#include <filesystem>
#include <string>

#include "recorder/formats/surface_bytes.h"
#include "sim/geometry/isosurface_stuffing.h"

namespace calot::recorder {

/// parseSurface() of a file. @throws Error (damaged)
TriangleMesh readSurface(const std::filesystem::path& path, LengthUnit unit, const SurfaceLimits& limits = {});

/// parseObj() of a file. @throws Error (damaged)
TriangleMesh readObj(const std::filesystem::path& path, LengthUnit unit, const SurfaceLimits& limits = {});

/// Writes formatObj() under a temporary name, then renames.
/// @throws Error (invalid) where the file exists and `force` is not set, or its folder does not exist; (failure) where
/// writing fails. Nothing half-written stays.
void writeObj(const std::filesystem::path& path, const TriangleMesh& mesh, const std::string& comment, bool force);

/// The text of a VTK file, in metres. Coordinates are written so that they are read back bit for bit.
/// @param title one line, at most 255 characters (more is cut off)
std::string formatVtk(const TetrahedralMesh& mesh, const std::string& title);

/// Writes it under a temporary name, then renames.
/// @throws Error (invalid) where the file exists and `force` is not set, or its folder does not exist; (failure) where
/// writing fails. Nothing half-written stays.
void writeVtk(const std::filesystem::path& path, const TetrahedralMesh& mesh, const std::string& title, bool force);

}  // namespace calot::recorder
