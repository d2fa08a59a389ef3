// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/value_rows.h"

namespace py = pybind11;

namespace calot::python {

py::dict valueDict(const analytics::CheckpointValue& v) {
  py::dict row;
  row["name"] = v.name;
  row["subject"] = v.subject;
  row["version"] = v.version;
  row["value"] = v.value ? py::object(py::float_(*v.value)) : py::object(py::none());
  row["unit"] = v.unit;
  row["origin"] = analytics::nameOf(v.origin);
  row["filter"] = v.filter;
  row["availability"] = analytics::nameOf(v.availability);
  row["reason"] = v.reason;
  row["note"] = v.note;
  row["coverage"] = v.coverage ? py::object(py::float_(*v.coverage)) : py::object(py::none());
  return row;
}

}  // namespace calot::python
