// SPDX-License-Identifier: GPL-3.0-or-later
// A surface: the first byte chooses the format, and whether it is mended.
#include <array>
#include <string>

#include "recorder/formats/surface_bytes.h"
#include "recorder/surfaces/surface_mending.h"
#include "recorder/surfaces/surface_union.h"

#include "tests/fuzz/support/fuzz_target.h"

using namespace calot;

/// CGAL is not the target: the programs keep it apart in a process of its own.
namespace calot::recorder {
TriangleMesh uniteSurfaces(const std::vector<TriangleMesh>& piece) {
  throw Error(ErrorKind::refused, std::to_string(piece.size()));
}
}  // namespace calot::recorder

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  return fuzz::tried([&] {
    static constexpr std::array<const char*, 4> names{"a.obj", "a.stl", "a.ply", "a.off"};
    const std::uint8_t choice = fuzz::takeByte(bytes);
    const TriangleMesh mesh = recorder::parseSurface(
        bytes, names[choice % names.size()], recorder::LengthUnit::millimetre, {std::size_t{1} << 20U, 20'000, 40'000});
    constexpr int mended = 100;
    if ((choice & 4U) != 0 && mesh.triangles() <= mended)
      static_cast<void>(recorder::mendSurface(mesh, (choice & 8U) != 0));
  });
}
