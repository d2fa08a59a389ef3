// SPDX-License-Identifier: GPL-3.0-or-later
// Veins that branch, on a texture that repeats.
#include "gui/render/scene_resources.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>

namespace calot::gui {
namespace {

class VeinTexture : public testing::Test {
 protected:
  [[nodiscard]] int at(int s, int t) const {
    const int column = (s + veinSide) % veinSide, row = (t + veinSide) % veinSide;
    return texture_[static_cast<std::size_t>(row) * veinSide + static_cast<std::size_t>(column)];
  }
  std::vector<std::uint8_t> texture_ = makeVeinTexture();
};

TEST_F(VeinTexture, IsTheSameEveryTime) {
  EXPECT_EQ(texture_.size(), static_cast<std::size_t>(veinSide) * veinSide);
  EXPECT_EQ(texture_, makeVeinTexture());
}

TEST_F(VeinTexture, LeavesNoLargePlaceBare) {
  std::array<int, 16> covered{};
  for (int t = 0; t < veinSide; ++t)
    for (int s = 0; s < veinSide; ++s)
      covered[static_cast<std::size_t>(t / (veinSide / 4) * 4 + s / (veinSide / 4))] += at(s, t) > 60 ? 1 : 0;
  for (const int block : covered) {
    EXPECT_GT(block, veinSide * veinSide / 16 / 12);
    EXPECT_LT(block, veinSide * veinSide / 16 / 2) << "it is no sponge";
  }
}

/// Across its edges it is as smooth as within.
TEST_F(VeinTexture, RepeatsWithoutASeam) {
  const auto jumps = [&](int column) {
    int large = 0;
    for (int t = 0; t < veinSide; ++t) large += std::abs(at(column, t) - at(column - 1, t)) > 200 ? 1 : 0;
    return large;
  };
  int most = 0;
  for (int column = 1; column < veinSide; ++column) most = std::max(most, jumps(column));
  EXPECT_LE(jumps(0), most);
}

}  // namespace
}  // namespace calot::gui
