// SPDX-License-Identifier: GPL-3.0-or-later
// Gravity of a scene file that this build need not be able to read.
#include "recorder/formats/scene_assets.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

namespace calot::recorder {
namespace {

Vec3 down(const std::string& text) {
  Asset file{"scene.json", {}};
  for (const char letter : text) file.bytes.push_back(static_cast<std::byte>(letter));
  return downOf(file);
}

TEST(SceneGravity, IsADirection) {
  EXPECT_LT(
      (down(R"({"format": "of another version", "gravity": [0, -9.2, -3.4]})") - Vec3(0.0, -9.2, -3.4).normalized())
          .norm(),
      1e-12);
}

TEST(SceneGravity, IsTheDefaultWhereTheFileTellsOfNone) {
  for (const char* text : {"", "no scene", "[1]", "{}", R"({"gravity": 9.8})", R"({"gravity": [0, 0, 0]})",
                           R"({"gravity": [0, 1]})", R"({"gravity": [0, "down", 0]})", R"({"gravity": [1e999, 0, 0]})"})
    EXPECT_EQ(down(text), -Vec3::UnitY()) << text;
}

}  // namespace
}  // namespace calot::recorder
