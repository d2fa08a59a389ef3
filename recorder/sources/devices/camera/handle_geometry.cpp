// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/handle_geometry.h"

#include <cassert>

#include "sim/math/elementary.h"

namespace calot::recorder {

Vec3 TagPlace::corner(int k, double side) const {
  const double along = (k == 1 || k == 2) ? 0.5 : -0.5;
  const double across = k < 2 ? 0.5 : -0.5;
  return middle + side * (along * right + across * down);
}

int firstTagOf(Hand hand) { return hand == Hand::left ? 0 : 20; }

std::vector<TagPlace> handleTags(Hand hand, double scale) {
  const std::array<Vec3, 4> normals{Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitX(), -Vec3::UnitY()};
  const double half = 0.5 * tagPitch * scale;
  std::vector<TagPlace> out;
  for (std::size_t face = 0; face < normals.size(); ++face) {
    for (int row = 0; row < 2; ++row) {
      const Vec3 middle = half * normals[face] + (row == 0 ? -half : half) * Vec3::UnitZ();
      out.push_back({firstTagOf(hand) + 2 * static_cast<int>(face) + row, middle, normals[face].cross(Vec3::UnitZ()),
                     Vec3::UnitZ()});
    }
  }
  out.push_back({firstTagOf(hand) + capTag, -2.0 * half * Vec3::UnitZ(), -Vec3::UnitY(), Vec3::UnitX()});
  return out;
}

TagPlace flapAt(Hand hand, double angle, double scale) {
  const double half = 0.5 * tagPitch * scale;
  const Vec3 hinge(half, 0.0, 2.0 * half);
  const Vec3 down(sine(angle), 0.0, cosine(angle));
  return {firstTagOf(hand) + flapTag, hinge + flapGap * scale * down, -Vec3::UnitY(), down};
}

std::vector<TagPlace> boardTags(double scale) {
  std::vector<TagPlace> out;
  for (int row = 0; row < boardRows; ++row) {
    for (int column = 0; column < boardColumns; ++column) {
      const Vec3 middle(column - 0.5 * (boardColumns - 1), row - 0.5 * (boardRows - 1), 0.0);
      out.push_back({firstBoardTag + row * boardColumns + column, tagPitch * scale * middle});
    }
  }
  return out;
}

}  // namespace calot::recorder
