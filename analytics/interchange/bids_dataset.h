// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of attempts as a data set of the Brain Imaging Data Structure, which movement science shares motion in.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "analytics/checkpoints/motion.h"
#include "sim/scene/samples.h"

namespace calot::analytics {

/// One attempt's motion and what a data set says of it.
struct BidsAttempt {
  std::string file;         ///< where it is from, for errors
  std::string participant;  ///< pseudonym
  std::string task;         ///< scene, or the task of a motion
  std::string device;       ///< class of the tracking system
  std::string startUtc;     ///< orders the runs of a participant; is not handed out
  bool synthetic = false;   ///< made by a performer
  double seconds = 0.0;     ///< how long it lasted
  std::array<Motion, handCount> motion;
};

/// Writes a new folder, a data set of BIDS 1.9.0 with the modality "motion" (Jeung et al. 2024, Scientific Data
/// 11:716): `dataset_description.json`, `README`, `participants.tsv` with its `.json`, and for each attempt
/// `sub-P/motion/sub-P_task-T_tracksys-D_run-N_motion.tsv` with `_motion.json`, `_channels.tsv` and its `.json`.
///
/// A row of a motion is a point of the grid of motionRate from the attempt's begin: position of each mounted
/// instrument's tip before the filter (m, world frame) and, where it is known, its orientation as a unit quaternion
/// (filtered); "n/a" where nothing was measured. Labels are what BIDS allows, letters and digits: other characters of a
/// name are left out. Runs are numbered by start. No dates.
///
/// @return the files. @throws Error (refused) for an attempt without participant or motion, and for two names that
/// become one label; (invalid) where the folder is there; (failure) where it cannot be written
std::vector<std::filesystem::path> writeBidsDataset(std::vector<BidsAttempt> attempts,
                                                    const std::filesystem::path& folder, bool force = false);

}  // namespace calot::analytics
