// SPDX-License-Identifier: GPL-3.0-or-later
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

#include "recorder/sources/motion_clock.h"
#include "recorder/sources/motion_table.h"
#include "recorder/sources/tracked_motion.h"
#include "sim/math/linear.h"
#include "sim/math/record.h"

namespace calot::recorder {

struct HandColumns {
  std::array<std::string, 3> position;   ///< x y z
  std::vector<std::string> orientation;  ///< none; 3: angles; 4: quaternion w x y z; 9: rotation matrix row by row
  std::array<int, 3> sequence{2, 1,
                              0};  ///< axes about which the angles rotate, one after the other, in the body's frame
  bool radians = false;            ///< unit of the angles
  Quat axis = Quat::Identity();    ///< rotates z onto the instrument's axis in its own frame, towards the tip
  std::string status;              ///< column of the tracker's state, or empty
  std::vector<std::string> valid;  ///< its words for a measured pose
  std::string jaw, pedal;          ///< columns, or empty

  static std::vector<Field> fields();
};

/// Columns of a CSV file, their units and frame.
struct ColumnMap {
  std::string device;  ///< class of tracker, or empty
  std::string frame;
  bool leftHanded = false;  ///< the frame, whose z is reversed
  TableStyle style;
  double metres = 1.0;      ///< of a unit of length
  double rate = 0.0;        ///< rows a second (Hz); 0: `time` is a column
  std::string time;         ///< column
  std::string nanoseconds;  ///< column of nanoseconds beside it, or empty
  ClockFormat clock;
  bool dropsDisorder = false;  ///< rows whose time is not after the one before are left out
  bool verified = false;       ///< units and samples are right, whatever they look like
  std::string source;          ///< what a file without a map was recognised as, or empty
  std::vector<std::string> notes;
  std::array<std::optional<HandColumns>, handCount> hand;

  static std::vector<Field> fields();
};

/// @throws Error (damaged) naming file and place.
ColumnMap readColumnMap(const std::filesystem::path& file);
ColumnMap parseColumnMap(std::span<const std::byte> bytes, const std::string& file);

/// Largest file of a motion (bytes).
inline constexpr std::size_t maxMotionBytes = std::size_t{1} << 30U;

/// Reads a CSV file by its map.
/// @throws Error (damaged) naming the file's base name and the line: as MotionTable; times that do not increase,
/// or go beyond 1e6 s; positions beyond 5 m; invalid orientations (quaternions of a length off 1 by more than
/// 1e-2, matrices off a rotation by more than 1e-3); a hand with one measured row; units as checkUnits().
TrackedMotion readCsvMotion(const std::filesystem::path& file, const ColumnMap& map);
TrackedMotion parseCsvMotion(std::span<const std::byte> bytes, const std::string& file, const ColumnMap& map);

/// A map for a table of motion, as far as the file says: its header as one of motion_formats.h, or names and units of
/// columns. What the file leaves open is "?" in it.
struct GuessedMap {
  std::string source;  ///< "OptiTrack Motive", or "table"
  std::string json;
  std::vector<std::string> open;  ///< places of the map that are to be filled in
};

/// Reads a file's beginning.
/// @throws Error (damaged) where it is no table of motion, naming what it seems to be and what reads it.
GuessedMap guessColumns(const std::filesystem::path& file);
/// The map of a file that leaves nothing open. @throws Error as above; invalid, naming what is open
ColumnMap recognisedMap(const std::filesystem::path& file);
GuessedMap guessColumns(std::span<const std::byte> bytes, const std::string& file);

}  // namespace calot::recorder
