// SPDX-License-Identifier: GPL-3.0-or-later
// A State taken apart into named arrays of numbers, for naming what differs and for state files; and a step's results
// as an engine sends them, a row of each column of /observables one after the other.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "recorder/engine/engine.h"
#include "recorder/engine/wire.h"
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

std::optional<KeyframeDifference> differenceOf(const Model& model, const Keyframe& recorded, const Keyframe& here);

/// The columns of today's version of StepResult in a scene, in the order of recordings.
std::vector<wire::Column> resultColumns(const Model& model);

/// Appends a row. @pre the result is of that scene
void appendResultRow(const StepResult& result, wire::Bytes& out);

}  // namespace calot::recorder
