// SPDX-License-Identifier: GPL-3.0-or-later
// The table of schemas/observables.md is the list of fields of StepResult, row by row.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sim/scene/step_result.h"
#include "sim/scene/version.h"

namespace calot::recorder {
namespace {

template <class T>
constexpr const char* typeOf() {
  if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>) return "u1";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "u4";
  return "f8";
}

template <class T>
std::string shapeOf() {
  if constexpr (std::is_same_v<T, Vec3>) return "(N, 3)";
  if constexpr (std::is_same_v<T, Quat>) return "(N, 4)";
  if constexpr (std::is_same_v<T, std::vector<double>>) return "(N, S)";
  return "(N)";
}

/// Letters of the page: how many columns a kind of tissue has.
std::string letterOf(const std::string& path) {
  if (path.ends_with("/organs")) return "O";
  if (path.ends_with("/connective")) return "K";
  if (path.ends_with("/vessels")) return "V";
  return "A";
}

std::string row(const std::string& path, const ResultField& field, const char* type, const std::string& shape,
                const std::string& presence) {
  const std::string unit = field.unit;
  const std::string frame = field.frame;
  return fmt::format("| `{}/{}` | dataset | {} | {} | {} | B | SDF | {} | {} |", path, field.name, type, shape,
                     unit + (unit.empty() || frame.empty() ? "" : ", ") + frame, presence, field.meaning);
}

/// Rows of data sets, in the order of the content chain; the left hand stands for both.
struct Rows {
  std::vector<std::string> rows;

  template <class T>
  void one(const ResultGroup& group, const ResultField& field, T&) {
    std::string path = group.path;
    if (path == "/observables/right") return;
    if (path == "/observables/left") path = "/observables/<hand>";
    using Value = std::remove_const_t<T>;
    const std::string present = shapeOf<Value>() == "(N, S)" ? "required if S"
                                : field.since > 1            ? fmt::format("required if V{}", field.since)
                                                             : "required";
    rows.push_back(row(path, field, typeOf<Value>(), shapeOf<Value>(), present));
  }
  template <class Part, class T>
  void each(const ResultGroup& group, const ResultField& field, const std::vector<Part>&, T Part::*) {
    const std::string letter = letterOf(group.path);
    // Columns that a version added to an earlier group: O3, K4, T4 (vessels), A4.
    const std::string present =
        field.since > group.since ? fmt::format("{}{}", letter == "V" ? "T" : letter, field.since) : letter;
    rows.push_back(row(group.path, field, typeOf<T>(), fmt::format("(N, {})", letter), "required if " + present));
  }
};

TEST(ObservablesPage, ListsTheFieldsAsTheyAre) {
  Rows wanted;
  const StepResult result;
  StepResult::fields(result, stepResultVersion, wanted);
  std::ifstream page(std::filesystem::path(CALOT_SOURCE_DIR) / "schemas/observables.md");
  std::vector<std::string> found;
  for (std::string line; std::getline(page, line);) {
    const bool dataset = line.starts_with("| `/observables/") && line.find("| dataset |") != std::string::npos;
    if (dataset && line.find("/observables/procedure/") == std::string::npos) found.push_back(line);
  }
  ASSERT_EQ(found.size(), wanted.rows.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], wanted.rows[i]);
}

}  // namespace
}  // namespace calot::recorder
