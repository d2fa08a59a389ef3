// SPDX-License-Identifier: GPL-3.0-or-later
// A step's results as an engine sends them: a row of each column of /observables, one after the other.
#pragma once

#include <vector>

#include "recorder/engine/wire.h"
#include "sim/scene/model.h"
#include "sim/scene/step_result.h"

namespace calot::recorder {

/// The columns of today's version of StepResult in a scene, in the order of recordings.
std::vector<wire::Column> resultColumns(const Model& model);

/// Appends a row. @pre the result is of that scene
void appendResultRow(const StepResult& result, wire::Bytes& out);

}  // namespace calot::recorder
