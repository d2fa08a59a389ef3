// SPDX-License-Identifier: GPL-3.0-or-later
// A surface: the first byte says of which format.
#include <array>

#include "recorder/formats/surface_bytes.h"

#include "tests/fuzz/support/fuzz_target.h"

using namespace calot;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  return fuzz::tried([&] {
    static constexpr std::array<const char*, 3> names{"a.obj", "a.stl", "a.ply"};
    const std::uint8_t choice = fuzz::takeByte(bytes);
    recorder::parseSurface(bytes, names[choice % names.size()], recorder::LengthUnit::millimetre,
                           {std::size_t{1} << 20U, 20'000, 40'000});
  });
}
