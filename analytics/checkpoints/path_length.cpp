// SPDX-License-Identifier: GPL-3.0-or-later
// Path length of the real tip. Unfiltered it measures the tracker's noise: 0.2 mm at 100 Hz lengthen it by 42 %.
#include "analytics/checkpoints/entries.h"

#include <fmt/format.h>

#include <cmath>

#include "analytics/checkpoints/motion.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& definition() {
  static const CheckpointDefinition d{
      .name = "path-length",
      .title = "Path length of the instrument's tip",
      .unit = "m",
      .displayUnit = "mm",
      .displayFactor = 1000.0,
      .direction = Direction::lower,
      .window = "whole attempt, while an instrument is mounted and measured",
      .aggregation = Aggregation::hand,
      .instruments = "each hand by itself",
      .filter = motionFilterText,
      .origins = {Origin::samples},
      .finality = Finality::final,
      .version = 1,
      .definition = "L = sum |p(k+1) - p(k)| over the filtered points of the real tip p_WI, within segments",
      .paperReading =
          "Total trajectory dist. (left), (right) (mm): path of the real tip in the world, not of the "
          "device's handle nor of the simulated tip",
  };
  return d;
}

class PathLength final : public Checkpoint {
 public:
  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    std::vector<CheckpointValue> result;
    for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h)
      result.push_back(ofHand(handNames[h], *end.motion[h]));
    return result;
  }

 private:
  static CheckpointValue ofHand(const char* hand, const Motion& motion) {
    if (!motion.mounted) {
      return makeMissing(definition(), hand, Origin::samples, Availability::notApplicable,
                         "no instrument in this hand");
    }
    if (motion.segments.empty()) {
      return makeMissing(definition(), hand, Origin::samples, Availability::notAvailable,
                         "no measured motion of 0.1 s or longer");
    }
    double length = 0.0;
    for (const MotionSegment& segment : motion.segments) {
      for (std::size_t i = 1; i < segment.filtered.size(); ++i) {
        const double dx = segment.filtered[i].x() - segment.filtered[i - 1].x();
        const double dy = segment.filtered[i].y() - segment.filtered[i - 1].y();
        const double dz = segment.filtered[i].z() - segment.filtered[i - 1].z();
        length += std::sqrt(dx * dx + dy * dy + dz * dz);
      }
    }
    // Less than a tenth of a second is the grid's rounding at the ends.
    std::string note =
        motion.unmeasured > longestBridge ? fmt::format("{:.3f} s without measurement", motion.unmeasured) : "";
    return makeValue(definition(), hand, Origin::samples, length, std::move(note));
  }
};

}  // namespace

CheckpointEntry pathLengthEntry() {
  return {definition(),
          [](const AttemptContext&) -> std::unique_ptr<Checkpoint> { return std::make_unique<PathLength>(); }};
}

}  // namespace calot::analytics
