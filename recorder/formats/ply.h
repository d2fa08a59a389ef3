// SPDX-License-Identifier: GPL-3.0-or-later
// PLY surfaces: format 1.0, ascii, binary_little_endian and binary_big_endian. Wanted are an element `vertex` with x, y
// and z and an element `face` with the list `vertex_indices` (or `vertex_index`), in either order; polygons are cut
// into fans. Every other property and element is passed over (triangle strips among them: a file with those alone has
// no face, and is refused).
// The header of a PLY file, which describes its body. Internal to this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recorder/formats/surface_bytes.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot::recorder {

/// A surface from a PLY file's bytes, in metres. Indices are in range and coordinates finite; nothing else is promised.
/// @param name what messages call it
/// @throws Error (damaged): "name:line: what is wrong"; after the header of a binary file "name: vertex n: what is
/// wrong" (elements are counted from 0)
TriangleMesh parsePly(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                      const SurfaceLimits& limits = {});

enum class PlyFormat : std::uint8_t { ascii, littleEndian, bigEndian };
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes of one value.
std::size_t plyBytes(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  bool list = false;
  PlyType countType = PlyType::uint8;  ///< of a list: whole numbers
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;  ///< at least one

  /// Place of a property, or -1.
  [[nodiscard]] int find(std::string_view property) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;  ///< names differ, as do those of each one's properties
  std::size_t lines = 0;             ///< of the header
};

/// Parses and removes the header of a file's text, up to and including the line "end_header". The element `vertex` has
/// x, y and z and `face` a list of indices, both within the limits. @throws Error (damaged): "name:line: what is wrong"
PlyHeader takePlyHeader(std::string_view& text, const std::string& name, const SurfaceLimits& limits);

/// The property that holds a face's corners, or -1.
int plyCorners(const PlyElement& face);

}  // namespace calot::recorder
