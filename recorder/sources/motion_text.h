// SPDX-License-Identifier: GPL-3.0-or-later
// Motion files whose text is no table, written as one: names of columns, then rows.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace calot::recorder {

/// Must a file be rewritten as a table, or refused: records of a Polhemus tracker, a sequence of PLUS or Slicer, no
/// text? @param text its beginning
bool isRewritten(std::string_view text);

/// A file's text: decoded, and rewritten as a comma-separated table:
/// - Polhemus: "station1_x" to "station1_roll" of each station; records of one sample in one row;
/// - PLUS, Slicer: "Timestamp", and of each transform "NAME_x", "NAME_y", "NAME_z", "NAME_r11" to "NAME_r33" (row by
///   row) and "NAME_status" below the frame in which it is.
/// - robomimic: demonstrations.h says.
/// @param demonstration as `wanted` there @param converted holds the text where it was changed, and outlives it
/// @throws Error (damaged) naming what the file is and what reads it: Parquet, spreadsheets, bags, databases
std::string_view motionText(std::span<const std::byte> bytes, const std::string& file,
                            const std::optional<std::string>& demonstration, std::string& converted);

}  // namespace calot::recorder
