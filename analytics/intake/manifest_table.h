// SPDX-License-Identifier: GPL-3.0-or-later
// A manifest: a table that says, a row each, what is taken into a cohort.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recorder/base/csv.h"
#include "recorder/base/errors.h"

namespace calot::analytics {

/// Cells by the names of their columns, some of which may be absent.
class ManifestTable {
 public:
  /// @param known columns that a manifest of its kind may have; a name that ends with ":" stands for all that begin so.
  /// A column "note" is passed over. @throws Error (invalid) for a column that is not known, so that
  /// a misspelt one is not lost without a word, or one that is there twice.
  ManifestTable(CsvTable table, const std::vector<std::string>& known);

  [[nodiscard]] const std::string& path() const { return table_.path; }
  [[nodiscard]] const std::vector<std::string>& columns() const { return table_.columns; }
  [[nodiscard]] const std::vector<CsvRow>& rows() const { return table_.rows; }
  [[nodiscard]] bool has(const std::string& column) const { return table_.has(column); }
  /// Empty where there is no such column.
  [[nodiscard]] std::string cell(const CsvRow& row, const std::string& column) const;
  /// A file that a cell names; relative ones lie beside the manifest.
  [[nodiscard]] std::filesystem::path fileNamed(const std::string& cell) const;

  /// "M.csv: line 4: column "mode": FAULT" (damaged).
  [[nodiscard]] Error fault(const CsvRow& row, const std::string& column, const std::string& what) const;

 private:
  CsvTable table_;
};

/// True if a name holds a line break or another control character, which could forge output.
bool holdsControl(const std::string& name);

}  // namespace calot::analytics
