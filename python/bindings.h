// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of the extension module `calot._calot`. It hands over bytes and plain values; the package around it
// (calot/*.py) makes arrays of them.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstddef>
#include <filesystem>
#include <mutex>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "recorder/base/errors.h"
#include "recorder/engine/wire.h"
#include "recorder/replay.h"

namespace calot::python {

using namespace pybind11::literals;

void bindRecording(pybind11::module_& m);
void bindReplay(pybind11::module_& m);
void bindMoment(pybind11::module_& m);
void bindCohort(pybind11::module_& m);
void bindAttempt(pybind11::module_& m);

/// Folders that may hold scenes, organs and performers (recorder::ProgramFiles): beside the programs that the module
/// was built or installed with.
std::vector<std::filesystem::path> assetFolders();

/// Throws what a verdict amounts to; returns where it is exact. @throws Error (refused, damaged, undecided)
void throwUnlessExact(const recorder::ReplayReport& report);

/// Result of a task that runs without Python's lock.
template <class Task>
auto withoutLock(const Task& task) {
  const pybind11::gil_scoped_release release;
  return task();
}
/// The same of an object that several threads may use, one at a time.
template <class Task>
auto alone(std::mutex& mutex, const Task& task) {
  const pybind11::gil_scoped_release release;
  const std::lock_guard lock(mutex);
  return task();
}

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
