// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include "sim/math/linear.h"

namespace calot {

/// The part of an instrument that is inside the body, for contact: a capsule from the tip to the port, in pieces.
struct Shaft {
  static constexpr double pieceLength = 0.02;    ///< m
  static constexpr std::size_t mostPieces = 15;  ///< the last one takes the rest of the shaft

  Vec3 port = Vec3::Zero();
  Vec3 tip = Vec3::Zero();
  Vec3 axis = Vec3::Zero();
  double length = 0.0;
  double radius = 0.0;

  Shaft(const Vec3& port_, const Vec3& tip_, double radius_) : port(port_), tip(tip_), radius(radius_) {
    const Vec3 reach = tip - port;
    length = reach.norm();
    axis = reach / length;
  }
  /// Pieces from the tip towards the port; the capsule's cap ends at the tip.
  [[nodiscard]] std::size_t pieces() const {
    const double inside = std::max(length - radius, 0.0);
    return std::clamp<std::size_t>(static_cast<std::size_t>(inside / pieceLength) + 1, 1, mostPieces);
  }
  [[nodiscard]] std::pair<Vec3, Vec3> piece(std::size_t k) const {
    const double from = radius + pieceLength * static_cast<double>(k);
    const double to = k + 1 == pieces() ? length : from + pieceLength;
    return {tip - std::min(from, length) * axis, tip - std::min(to, length) * axis};
  }
};

}  // namespace calot
