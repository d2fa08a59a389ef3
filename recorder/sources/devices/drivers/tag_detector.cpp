// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/sources/devices/camera/frame_source.h"

#include <algorithm>
#include <cassert>

#include "recorder/sources/devices/camera/marker_sheets.h"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
}

namespace calot::recorder {
namespace {

constexpr int mostCorrected = 1;
constexpr double leastMargin = 20.0;  // grey levels

}  // namespace

TagDetector makeTagDetector() {
  const std::shared_ptr<apriltag_family> family(tag36h11_create(), tag36h11_destroy);
  // Its end frees what it added to the family: the family ends after it.
  const std::shared_ptr<apriltag_detector> detector(apriltag_detector_create(),
                                                    [family](apriltag_detector* d) { apriltag_detector_destroy(d); });
  apriltag_detector_add_family_bits(detector.get(), family.get(), mostCorrected);
  detector->nthreads = 1;
  detector->quad_decimate = 2.0F;  // edges are refined in the full picture
  detector->refine_edges = true;
  return [detector](const GreyImage& image) {
    assert(image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    // The library reads alone.
    image_u8_t view{image.width, image.height, image.width, const_cast<std::uint8_t*>(image.pixels.data())};
    zarray_t* const found = apriltag_detector_detect(detector.get(), &view);
    std::vector<SeenTag> out;
    for (int i = 0; i < zarray_size(found); ++i) {
      apriltag_detection_t* tag = nullptr;
      zarray_get(found, i, &tag);
      if (tag->hamming > mostCorrected || !(tag->decision_margin >= leastMargin)) continue;
      SeenTag seen{tag->id, tag->hamming, tag->decision_margin, {}};
      for (std::size_t k = 0; k < seen.corner.size(); ++k) seen.corner[k] = {tag->p[k][0], tag->p[k][1]};
      out.push_back(seen);
    }
    apriltag_detections_destroy(found);
    std::sort(out.begin(), out.end(), [](const SeenTag& a, const SeenTag& b) { return a.id < b.id; });
    std::vector<SeenTag> once;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const bool twice = (i > 0 && out[i - 1].id == out[i].id) || (i + 1 < out.size() && out[i + 1].id == out[i].id);
      if (!twice) once.push_back(out[i]);
    }
    return once;
  };
}

std::array<bool, 100> tagCells(int id) {
  const std::shared_ptr<apriltag_family> family(tag36h11_create(), tag36h11_destroy);
  assert(id >= 0 && static_cast<std::uint32_t>(id) < family->ncodes);
  const auto width = static_cast<std::uint32_t>(family->total_width);
  const std::uint32_t margin = (width - static_cast<std::uint32_t>(family->width_at_border)) / 2;
  std::array<bool, 100> cells{};
  assert(width * width == cells.size());
  // A white margin, a black border, and the bits in it: white where the code has a one, the highest first.
  for (std::uint32_t y = 0; y < width; ++y) {
    for (std::uint32_t x = 0; x < width; ++x)
      cells[width * y + x] = std::min({x, y, width - 1 - x, width - 1 - y}) >= margin;
  }
  const std::uint64_t code = family->codes[id];
  for (std::uint32_t i = 0; i < family->nbits; ++i) {
    if ((code >> (family->nbits - 1 - i) & 1U) != 0)
      cells[width * (family->bit_y[i] + margin) + family->bit_x[i] + margin] = false;
  }
  return cells;
}

}  // namespace calot::recorder
