// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/tracked_motion.h"

namespace calot::recorder {

TrackedMotion trackedMotion(const KinematicsMotion& motion) {
  TrackedMotion tracked;
  tracked.file = motion.file;
  tracked.sha256 = motion.sha256;
  tracked.rate = kinematicsRowsPerSecond;
  for (std::size_t h = 0; h < tracked.hand.size(); ++h) {
    TrackedHand& hand = tracked.hand[h];
    hand.present = hand.oriented = true;
    for (const auto& row : motion.rows) {
      hand.position.push_back(row[h].position);
      hand.orientation.push_back(row[h].orientation);
    }
  }
  for (std::size_t i = 0; i < motion.rows.size(); ++i)
    tracked.time.push_back(static_cast<double>(i) / kinematicsRowsPerSecond);
  return tracked;
}

}  // namespace calot::recorder
