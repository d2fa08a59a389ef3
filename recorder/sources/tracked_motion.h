// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of instruments without a scene, as a tracker measured it: what motion checkpoints are computed from
// where nothing was simulated.
// Two-handed instrument motion as text: 76 numbers a row, 30 rows a second, no clock. Four groups of 19 in the order
// master left, master right, slave left, slave right; in each group tip position (3, m), rotation matrix (9, row by
// row), linear velocity (3, m/s), angular velocity (3, rad/s), gripper angle (rad). The instruments' own motion is that
// of the slave groups.
// CSV files of instrument motion and the declaration of their columns: schemas/columns.schema.json defines such
// maps, docs/explanation/sources.md explains them.
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

/// The same from bytes.
KinematicsMotion parseKinematics(std::span<const std::byte> bytes, const std::string& file);

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

struct HandColumns {
  std::array<std::string, 3> position;   ///< x y z
  std::vector<std::string> orientation;  ///< none; 4: quaternion w x y z; 9: rotation matrix row by row
  Quat axis = Quat::Identity();          ///< rotates z onto the instrument's axis in its own frame, towards the tip

  static std::vector<Field> fields();
};

/// Columns of a CSV file, their units and frame.
struct ColumnMap {
  std::string device;  ///< class of tracker, or empty
  std::string frame;
  char delimiter = ',';
  double metres = 1.0;   ///< of a unit of length
  double rate = 0.0;     ///< rows a second (Hz); 0: `time` is a column
  std::string time;      ///< column
  double seconds = 1.0;  ///< of a unit of time
  std::array<std::optional<HandColumns>, handCount> hand;

  static std::vector<Field> fields();
};

/// @throws Error (damaged) naming file and place.
ColumnMap readColumnMap(const std::filesystem::path& file);
ColumnMap parseColumnMap(std::span<const std::byte> bytes, const std::string& file);

/// Reads a CSV file by its map.
/// @throws Error (damaged) naming the file's base name and the line: as readCsvNumbers(); times that do not increase,
/// or go beyond 1e6 s; positions beyond 5 m; invalid orientations (quaternions of a length off 1 by more than
/// 1e-2, matrices off a rotation by more than 1e-3); one row alone.
TrackedMotion readCsvMotion(const std::filesystem::path& file, const ColumnMap& map);
TrackedMotion parseCsvMotion(std::span<const std::byte> bytes, const std::string& file, const ColumnMap& map);

}  // namespace calot::recorder
