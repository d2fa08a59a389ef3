// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "analytics/cohort/cohort_database.h"

namespace calot::python {

/// A row by the names that `calot` gives its columns in JSON.
inline pybind11::dict dictOf(const analytics::Fields& fields) {
  pybind11::dict row;
  for (const auto& [name, value] : fields) row[pybind11::str(name)] = value;
  return row;
}

}  // namespace calot::python
