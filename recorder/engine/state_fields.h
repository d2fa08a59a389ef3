// SPDX-License-Identifier: GPL-3.0-or-later
// A State taken apart into named arrays of numbers, for naming what differs and for state files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "sim/scene/model.h"
#include "sim/scene/state.h"

namespace calot::recorder {

/// One field: its name ("organ.liver/position") and its numbers, flat, in storage order.
struct StateField {
  std::string name;
  std::variant<std::vector<double>, std::vector<std::uint64_t>> values;
};

/// Every field in the order of the digests.
std::vector<StateField> stateFields(const Model& model, const State& state);

struct FieldDifference {
  std::string field;        ///< "organ.liver/position"
  std::uint64_t index = 0;  ///< of the first number that differs
  std::string first;        ///< both values, with all digits; "absent" past the end
  std::string second;
};

/// The first difference in order, bit for bit, if there is one.
std::optional<FieldDifference> firstDifference(const std::vector<StateField>& first,
                                               const std::vector<StateField>& second);

}  // namespace calot::recorder
