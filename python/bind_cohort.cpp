// SPDX-License-Identifier: GPL-3.0-or-later
// Values of recordings and of cohorts.
#include <algorithm>
#include <iterator>
#include <string>

#include "analytics/assess.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/report/study_population.h"
#include "python/bindings.h"

namespace py = pybind11;

namespace calot::python {

namespace {

/// A row by the names that `calot` gives its columns in JSON.
py::dict dictOf(const analytics::Fields& fields) {
  py::dict row;
  for (const auto& [name, value] : fields) row[py::str(name)] = value;
  return row;
}

/// Judges a recording as `calot assess` does, and stores the values where a cohort is named.
py::tuple assessed(const std::filesystem::path& file, unsigned threads, double cutoff, bool apart,
                   const std::optional<std::filesystem::path>& cohort) {
  const auto& cutoffs = analytics::motionCutoffs;
  if (std::find(std::begin(cutoffs), std::end(cutoffs), cutoff) == std::end(cutoffs))
    throw Error(ErrorKind::invalid, "cutoff: 3, 6 or 10 Hz is expected");
  if (cohort && cutoff != analytics::motionCutoff)
    throw Error(ErrorKind::invalid, "cutoff: values of a cohort have one filter, 6 Hz");
  analytics::AssessSettings settings{.threads = threads, .cutoff = cutoff};
  settings.engine.apart = apart;
  const analytics::JudgedRecording judged = withoutLock([&] {
    analytics::JudgedRecording result = analytics::assessRecording(file.string(), settings);
    if (cohort && result.record)
      analytics::CohortDatabase(cohort->string(), analytics::CohortDatabase::Access::create)
          .storeAttempt(*result.record, result.values);
    if (result.report.verdict != recorder::ReplayVerdict::undecided || result.values.empty())
      throwUnlessExact(result.report);
    return result;
  });
  py::list values;
  for (const analytics::CheckpointValue& v : judged.values) values.append(dictOf(fieldsOf(v)));
  return py::make_tuple(reportOf(judged.report), values);
}

py::list checkpoints() {
  py::list list;
  for (const analytics::CheckpointEntry& entry : analytics::checkpointRegistry()) {
    const analytics::CheckpointDefinition& d = entry.definition;
    list.append(py::dict("name"_a = d.name, "title"_a = d.title, "unit"_a = d.unit, "version"_a = d.version,
                         "direction"_a = analytics::nameOf(d.direction),
                         "aggregation"_a = analytics::nameOf(d.aggregation), "definition"_a = d.definition));
  }
  return list;
}

/// A cohort's database, read. May be used by several threads, one at a time.
struct CohortReader {
  explicit CohortReader(const std::filesystem::path& path)
      : database(path.string(), analytics::CohortDatabase::Access::read) {}

  std::mutex mutex;
  analytics::CohortDatabase database;
};

py::dict cohortValueDict(const analytics::AttemptValue& v) {
  py::dict row = dictOf(fieldsOf(v.value));
  const bool bounded = v.interval && v.interval->lower;
  row["attempt"] = v.attempt;
  row["lower"] = bounded ? v.interval->lower : std::nullopt;
  row["upper"] = bounded ? v.interval->upper : std::nullopt;
  return row;
}

/// Rows of the cohort as a list of dicts.
template <class Read, class Dict>
auto listOf(Read read, Dict dict) {
  return [read, dict](CohortReader& cohort) {
    const auto rows = alone(cohort.mutex, [&] { return read(cohort.database); });
    py::list list;
    for (const auto& row : rows) list.append(dict(row));
    return list;
  };
}

}  // namespace

void bindCohort(py::module_& m) {
  m.def("assess", assessed, "path"_a, "threads"_a, "cutoff"_a, "apart"_a, "cohort"_a);
  m.def("checkpoints", checkpoints, "Definition of every checkpoint.");
  m.def(
      "phase_checkpoints", [] { return analytics::unaskedPhases({}); }, "Those that studies leave out unless asked.");
  const auto rowDict = [](const auto& row) { return dictOf(fieldsOf(row)); };
  py::class_<CohortReader>(m, "Cohort", "A cohort's database, opened for reading.")
      .def(py::init<const std::filesystem::path&>(), "path"_a, py::call_guard<py::gil_scoped_release>())
      .def("attempts", listOf([](const auto& d) { return d.listAttempts(); }, rowDict))
      .def("values", listOf([](const auto& d) { return d.allValues(); }, cohortValueDict))
      .def("participants", listOf([](const auto& d) { return d.participants(); }, rowDict));
  m.def("record_export", analytics::recordExport, "cohort"_a, "kind"_a, "target"_a, "attempts"_a,
        py::call_guard<py::gil_scoped_release>(),
        "Registers in a cohort an export of attempts to a file or folder, so that a withdrawal lists it.");
}

}  // namespace calot::python
