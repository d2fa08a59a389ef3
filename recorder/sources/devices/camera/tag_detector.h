// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <Eigen/Core>
#include <memory>
#include <vector>

namespace calot::recorder {

/// A picture of a camera in grey, rows from the top without gaps.
struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

struct SeenTag {
  int id = 0;
  int hamming = 0;                        ///< bits that were corrected
  double margin = 0.0;                    ///< contrast of its bits (grey levels)
  std::array<Eigen::Vector2d, 4> corner;  ///< pixels, in the order of TagPlace::corner
};

/// Finds tags of the family 36h11 (AprilTag 3: Krogius, Haggenmiller, Olson 2019, "Flexible layouts for fiducial tags",
/// IROS). One thread, and the same result every time.
class TagDetector {
 public:
  TagDetector();
  ~TagDetector();
  TagDetector(const TagDetector&) = delete;
  TagDetector& operator=(const TagDetector&) = delete;

  /// Tags with at most one corrected bit and clear contrast, in the order of their numbers. A number that is seen twice
  /// is left out: one of the two is false, and which cannot be said.
  std::vector<SeenTag> detect(const GreyImage& image);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace calot::recorder
