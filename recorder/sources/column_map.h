// SPDX-License-Identifier: GPL-3.0-or-later
// CSV files of instrument motion and the declaration of their columns: schemas/columns.schema.json defines such
// maps, docs/explanation/sources.md explains them.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "recorder/sources/tracked_motion.h"
#include "sim/math/record.h"

namespace calot::recorder {

/// Columns of a CSV file, their units and frame.
struct ColumnMap {
  struct HandColumns {
    std::array<std::string, 3> position;   ///< x y z
    std::vector<std::string> orientation;  ///< none; 4: quaternion w x y z; 9: rotation matrix row by row
    Quat axis = Quat::Identity();          ///< rotates z onto the instrument's axis in its own frame, towards the tip

    static std::vector<Field> fields();
  };
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
/// or go beyond 1e6 s; positions beyond 5 m; orientations that are none (quaternions of a length off 1 by more than
/// 1e-2, matrices off a rotation by more than 1e-3); one row alone.
TrackedMotion readCsvMotion(const std::filesystem::path& file, const ColumnMap& map);
TrackedMotion parseCsvMotion(std::span<const std::byte> bytes, const std::string& file, const ColumnMap& map);

}  // namespace calot::recorder
