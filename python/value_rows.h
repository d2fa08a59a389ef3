// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include "analytics/checkpoints/checkpoint.h"

namespace calot::python {

/// A value with the keys of `calot assess` in its JSON form.
pybind11::dict valueDict(const analytics::CheckpointValue& value);

}  // namespace calot::python
