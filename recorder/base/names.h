// SPDX-License-Identifier: GPL-3.0-or-later
// Names in tables: of people, groups, places. What people see as one name is one text.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "recorder/base/csv.h"

namespace calot::recorder {

/// The composed form of Unicode (NFC); what is not UTF-8 as it is.
std::string composedName(std::string_view name);

/// The meaning of names that differ in capitals, compatible characters or leading zeros alone: "P1" and "p1", "001" and
/// "1".
enum class SimilarNames : std::uint8_t {
  ask,  ///< nobody said: they are refused
  one,  ///< one name, spelt as it was first
  two,
};

struct NameColumn {
  std::string name;                     ///< nothing happens where a table has no such column
  std::vector<std::string> known = {};  ///< names of its kind that are stored elsewhere
};

/// Spells the names in these columns of a table as above.
/// @throws Error (refused), naming line and column of a name that is similar to another one
void spellNames(CsvTable& table, const std::vector<NameColumn>& columns, SimilarNames similar);

}  // namespace calot::recorder
