// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of the extension module `calot._calot`. It hands over bytes and plain values; the package around it
// (calot/*.py) makes arrays of them.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstddef>
#include <vector>

#include "recorder/engine/wire.h"
#include "recorder/replay.h"

namespace calot::python {

void bindRecording(pybind11::module_& m);
void bindReplay(pybind11::module_& m);
void bindMoment(pybind11::module_& m);
void bindAssess(pybind11::module_& m);
void bindCohort(pybind11::module_& m);
void bindAttempt(pybind11::module_& m);
void bindRecord(pybind11::module_& m);

inline pybind11::bytes bytesOf(const void* data, std::size_t size) { return {static_cast<const char*>(data), size}; }
template <class T>
pybind11::bytes bytesOf(const std::vector<T>& values) {
  return bytesOf(values.data(), values.size() * sizeof(T));
}

/// (path, type, width) of each column of a row of results.
pybind11::list columnList(const std::vector<recorder::wire::Column>& columns);

/// As `calot replay` in its JSON form has it, as far as Python asks for it.
pybind11::dict reportOf(const recorder::ReplayReport& report);

}  // namespace calot::python
