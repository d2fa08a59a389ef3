// SPDX-License-Identifier: GPL-3.0-or-later
// Objects of JSON files whose values are plain numbers: one table for their rules, for reading and for writing.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "recorder/base/json_reader.h"

namespace calot::recorder {

/// A key, its bounds, and where its value is kept. Lists have the length of their span; quaternions are w x y z, unit.
/// An optional one that the file omits stays empty, and one that is empty is not written.
struct JsonValue {
  KeyRule rule;
  std::variant<double*, std::uint32_t*, int*, bool*, std::span<double>, Vec3*, Quat*, std::optional<double>*,
               std::optional<Vec3>*, std::optional<Quat>*>
      value;
};
using JsonValues = std::vector<JsonValue>;

ObjectRule ruleOf(std::string definition, const JsonValues& values);

/// Reads an object that has these values and no others.
/// @throws Error (damaged) with file and JSON pointer
void readValues(const JsonPlace& place, const JsonValues& values);

nlohmann::ordered_json jsonOf(const JsonValues& values);

}  // namespace calot::recorder
