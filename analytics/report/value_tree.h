// SPDX-License-Identifier: GPL-3.0-or-later
// Results as one tree of values, and what is written of a tree: JSON as it is, CSV files and tables by the paths of
// their columns.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "analytics/report/report_document.h"
#include "analytics/statistics/expected.h"

/// @cond
/// Null where there is none.
template <class T>
struct nlohmann::adl_serializer<std::optional<T>> {
  template <class Tree>
  static void to_json(Tree& tree, const std::optional<T>& value) {
    tree = value ? Tree(*value) : Tree(nullptr);
  }
};

/// {"value": null, "reason": ...} where there is none.
template <class T>
struct nlohmann::adl_serializer<calot::analytics::Expected<T>> {
  template <class Tree>
  static void to_json(Tree& tree, const calot::analytics::Expected<T>& value) {
    tree = value ? Tree(*value) : Tree{{"value", nullptr}, {"reason", value.reason()}};
  }
};
/// @endcond

namespace calot::analytics {

using ValueTree = nlohmann::ordered_json;

template <class Tree>
void to_json(Tree& tree, const Interval& i) {
  tree = {{"lower", i.lower}, {"upper", i.upper}, {"level", i.level}, {"method", i.method}};
}

/// The tree that `write` makes of a result, or the reason why there is none.
template <class T, class Write>
ValueTree treeOf(const Expected<T>& result, Write write) {
  if (!result) return {{"value", nullptr}, {"reason", result.reason()}};
  return write(*result);
}

/// A CSV file of the tree's rows, a line each. Numbers have the digits that give them back, true and false are "yes"
/// and "no", a list's texts are joined by "; ", and what is null or not there is an empty cell.
/// @param columns apart by blanks, each with the path of its cell in a row where that is not the name: "unit
/// area_lower=/area/interval/lower"
std::string csvText(const ValueTree& rows, const std::string& columns);

/// A cell of a table. @param value null where the row has none
using CellText = std::string (*)(const ValueTree& value);
/// The same of a checkpoint's value. @param row names the checkpoint or the figure
using FigureText = std::string (*)(const ValueTree& value, const ValueTree& row);
struct TreeColumn {
  std::string title;  ///< as of tableOf()
  std::string path;   ///< of the value in a row; empty: the row
  std::variant<CellText, FigureText> text;
};
ReportTable tableOf(const std::string& title, const ValueTree& rows, const std::vector<TreeColumn>& columns);

// Texts of cells; "-" where a number is missing.
std::string plain(const ValueTree& value);    ///< a text or a whole number; empty where it is missing
std::string digits4(const ValueTree& value);  ///< significant()
std::string digits3(const ValueTree& value);
std::string share2(const ValueTree& value);   ///< "0.71"
std::string share3(const ValueTree& value);   ///< "0.714"
std::string signed2(const ValueTree& value);  ///< "+0.71"
std::string signed3(const ValueTree& value);  ///< "+0.714"
std::string pValue(const ValueTree& value);   ///< pText()
std::string range4(const ValueTree& value);   ///< "[1.2, 3.4]" of {"lower", "upper"}
std::string range3(const ValueTree& value);
std::string shares2(const ValueTree& value);  ///< "[0.61, 0.80]" of the same
std::string shares3(const ValueTree& value);

// Texts of a checkpoint's values: figureNumber().
std::string figure4(const ValueTree& value, const ValueTree& row);
std::string figure3(const ValueTree& value, const ValueTree& row);
std::string figureRange4(const ValueTree& value, const ValueTree& row);  ///< of {"lower", "upper"}
std::string figureRange3(const ValueTree& value, const ValueTree& row);

}  // namespace calot::analytics
