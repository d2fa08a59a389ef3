// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of instruments without a scene, as a tracker measured it: what motion checkpoints are computed from
// where nothing was simulated.
// Two-handed instrument motion as text: 76 numbers a row, 30 rows a second, no clock. Four groups of 19 in the order
// master left, master right, slave left, slave right; in each group tip position (3, m), rotation matrix (9, row by
// row), linear velocity (3, m/s), angular velocity (3, rad/s), gripper angle (rad). The instruments' own motion is that
// of the slave groups.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/math/linear.h"
#include "sim/math/record.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// One slave instrument in one row, in the file's frame F.
struct KinematicsPose {
  Vec3 position = Vec3::Zero();         ///< p_FI (m)
  Quat orientation = Quat::Identity();  ///< q_FI, from the matrix, normalised
  double gripper = 0.0;                 ///< rad
};

struct KinematicsMotion {
  std::string file;                                         ///< base name
  std::string sha256;                                       ///< of the file's bytes, hexadecimal
  std::vector<std::array<KinematicsPose, handCount>> rows;  ///< row i is at i / rowsPerSecond
};

inline constexpr int kinematicsRowsPerSecond = 30;

/// Reads and checks a file: every number of every row finite, positions within 5 m, rotation matrices orthonormal
/// within 1e-3, two rows at least and a million at most.
/// @throws Error (damaged) naming the file's base name and the line.
KinematicsMotion readKinematics(const std::filesystem::path& file);

/// Is it such a file, by its name and its first line? Blanks, commas or semicolons stand between its numbers.
bool isKinematicsFile(const std::filesystem::path& file);

/// The same from bytes.
KinematicsMotion parseKinematics(std::span<const std::byte> bytes, const std::string& file);

struct TrackedHand {
  bool present = false;            ///< the file has this hand
  bool oriented = false;           ///< and its orientation
  std::vector<Vec3> position;      ///< p of the tip in the file's frame (m); NaN where the file has none
  std::vector<Quat> orientation;   ///< unit; z along the shaft towards the tip; may be empty where not oriented
  std::vector<double> jaw;         ///< opening angle (rad), NaN where it is missing; empty: the file has none
  std::vector<bool> pedal;         ///< pressed; empty: the file has none
  std::vector<bool> missing;       ///< rows that are no sample: not measured, or invalid (markInvalidSamples())
  std::vector<std::size_t> jumps;  ///< rows from which the motion goes on elsewhere, in order
  std::size_t leftOut = 0;         ///< rows that are missing because their sample is invalid

  [[nodiscard]] bool isMissing(std::size_t row) const { return row < missing.size() && missing[row]; }
  [[nodiscard]] Quat orientationAt(std::size_t row) const {
    return row < orientation.size() ? orientation[row] : Quat::Identity();
  }
};

/// Every row of a file; what is present has as many.
struct TrackedMotion {
  std::string file;                ///< base name
  std::string sha256;              ///< of the file's bytes, hexadecimal
  std::string device;              ///< class of tracker as declared, or empty
  std::string frame;               ///< as declared, or empty
  double rate = 0.0;               ///< rows a second (Hz); 0: each row has its time
  std::vector<double> time;        ///< of each row since the first (s), increasing
  std::vector<std::string> notes;  ///< a line each on what was left out, or how the file was read
  std::array<TrackedHand, handCount> hand;
};

/// The slave instruments of a kinematics file.
TrackedMotion trackedMotion(const KinematicsMotion& motion);

/// Finds samples that no hand gives and marks them as missing, with a note each:
/// - positions beyond a jump (a step that is longer than the steps before and after it by more than 2 mm, 50 m/s^2 and
///   ten times the median second difference, or faster than 5 m/s) for less than half a second, or at the origin;
///   motion that goes on elsewhere after a jump is divided there;
/// - a pose that is repeated for longer than 0.1 s and three of the tracker's intervals, and left with a jump of more
///   than 1 mm, 10 m/s^2 and ten times the median second difference: held while the tracker saw nothing.
void markInvalidSamples(TrackedMotion& motion);

/// @throws Error (damaged) where rows are more than 1 s or less than 50 us apart, or the faster hand is slower than
/// 5 mm/s, or faster than 2 m/s, for 95 % of the time: units are wrong. Motions of less than 5 s pass.
void checkUnits(const TrackedMotion& motion);

}  // namespace calot::recorder
