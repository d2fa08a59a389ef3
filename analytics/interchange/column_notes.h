// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string_view>

namespace calot::analytics {

/// Description of a column.
struct ColumnNote {
  std::string_view table, column, title;
  std::string_view unit = "", allowed = "", missing = "";
};

/// Of the database's tables (schemas/cohort) and of a bundle's files; a test holds them against both.
std::span<const ColumnNote> columnNotes();

/// Null where there is none.
const ColumnNote* noteOn(std::string_view table, std::string_view column);

}  // namespace calot::analytics
