// SPDX-License-Identifier: GPL-3.0-or-later
// The motion that checkpoints are computed of, as tables for other programs.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "analytics/checkpoints/motion.h"
#include "sim/scene/samples.h"

namespace calot::analytics {

/// Writes a new folder of
///
/// - `motion_left.csv`, `motion_right.csv`: a row each point on the grid of motionRate: time (s), number of the segment
///   (from 1), filtered position of the tip in the world frame (m), orientation (w, x, y, z; no columns where it is not
///   known), speed (m/s), the position before the filter (m), number of the movement (from 1; empty: in none);
/// - `spans.csv`: by hand what is `mounted`, `lost` (mounted without measurement), a `segment`, a `movement`, from
/// begin up
///   to end (s), and of segments whether they follow a gap that was too long to be bridged;
/// - `motion.json`: filter, and by hand coverage, rate, interval and threshold of movements.
///
/// Numbers are the shortest that give the same bits. @return the files. @throws Error (invalid) where the folder is
/// there; (failure) where it cannot be written
std::vector<std::filesystem::path> writeMotionTables(const std::array<Motion, handCount>& motion,
                                                     const std::filesystem::path& folder, bool force = false);

}  // namespace calot::analytics
