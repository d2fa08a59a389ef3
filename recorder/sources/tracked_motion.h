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
#include <span>
#include <string>
#include <vector>

#include "sim/math/linear.h"
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

/// The same from bytes.
KinematicsMotion parseKinematics(std::span<const std::byte> bytes, const std::string& file);

/// One hand's rows.
struct TrackedHand {
  bool present = false;           ///< the file has this hand
  bool oriented = false;          ///< and its orientation
  std::vector<Vec3> position;     ///< p of the tip in the file's frame (m)
  std::vector<Quat> orientation;  ///< unit; z along the shaft towards the tip. Identities where not oriented
};

/// Every row of a file; what is present has as many.
struct TrackedMotion {
  std::string file;          ///< base name
  std::string sha256;        ///< of the file's bytes, hexadecimal: the motion's identity
  std::string device;        ///< class of tracker as declared, or empty
  std::string frame;         ///< as declared, or empty
  double rate = 0.0;         ///< rows a second (Hz); 0: each row has its time
  std::vector<double> time;  ///< of each row since the first (s), increasing
  std::array<TrackedHand, handCount> hand;
};

/// The slave instruments of a kinematics file.
TrackedMotion trackedMotion(const KinematicsMotion& motion);

}  // namespace calot::recorder
