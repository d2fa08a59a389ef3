// SPDX-License-Identifier: GPL-3.0-or-later
// A scene file; whatever it names is one small tetrahedron.
#include "recorder/formats/scene_assets.h"

#include "tests/fuzz/support/fuzz_target.h"

using namespace calot;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  return fuzz::tried([&] {
    static const recorder::Asset mesh = [] {
      const std::string text = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
      const auto* first = reinterpret_cast<const std::byte*>(text.data());
      return recorder::Asset{"a.obj", {first, first + text.size()}};
    }();
    const recorder::FetchAsset fetch = [&](const std::string&, const recorder::JsonPlace&) -> const recorder::Asset& {
      return mesh;
    };
    recorder::parseScene({"scene.json", {bytes.begin(), bytes.end()}}, fetch);
  });
}
