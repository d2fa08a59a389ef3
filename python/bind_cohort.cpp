// SPDX-License-Identifier: GPL-3.0-or-later

#include <mutex>
#include <string>

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/withdraw.h"
#include "python/bindings.h"
#include "python/value_rows.h"

namespace py = pybind11;

namespace calot::python {

namespace {

/// A cohort's database, read. May be used by several threads, one at a time.
class CohortReader {
 public:
  explicit CohortReader(const std::filesystem::path& path)
      : database_(path.string(), analytics::CohortDatabase::Access::read) {}

  std::vector<analytics::AttemptRow> attempts() {
    const std::lock_guard lock(mutex_);
    return database_.listAttempts();
  }
  std::vector<analytics::AttemptValue> values() {
    const std::lock_guard lock(mutex_);
    return database_.allValues();
  }
  std::vector<analytics::Participant> participants() {
    const std::lock_guard lock(mutex_);
    return database_.participants();
  }

 private:
  std::mutex mutex_;
  analytics::CohortDatabase database_;
};

py::dict attemptDict(const analytics::AttemptRow& a) {
  py::dict row;
  row["attempt"] = a.uuid;
  row["parent"] = a.parent;
  row["participant"] = a.participant;
  row["group"] = a.group;
  row["arm"] = a.arm;
  row["site"] = a.site;
  row["scene"] = a.scene;
  row["scene_major"] = a.sceneMajor;
  row["scene_minor"] = a.sceneMinor;
  row["operator"] = recorder::wordFor(a.operatorKind);
  row["profile"] = a.profile;
  row["profile_version"] = a.profileVersion;
  row["synthetic"] = a.synthetic;
  row["mode"] = recorder::wordFor(a.mode);
  row["purpose"] = a.purpose;
  row["outcome"] = recorder::wordFor(a.outcome);
  row["start_utc"] = a.startUtc;
  row["seed"] = a.seed;
  row["device"] = a.device;
  row["station"] = a.station;
  row["simulation_version"] = a.simulationVersion;
  row["key"] = a.comparabilityKey;
  row["file"] = a.fileName;
  row["complete"] = a.complete;
  row["seconds"] = static_cast<double>(a.steps) * a.stepSeconds;
  row["verdict"] = analytics::nameOf(a.verification.verdict);
  row["excluded"] = a.excluded;
  row["withdrawn"] = a.withdrawn;
  row["tags"] = a.tags;
  return row;
}

py::dict cohortValueDict(const analytics::AttemptValue& v) {
  py::dict row = valueDict(v.value);
  row["attempt"] = v.attempt;
  const bool bounded = v.interval && v.interval->lower;
  row["lower"] = bounded ? py::object(py::float_(*v.interval->lower)) : py::object(py::none());
  row["upper"] = bounded ? py::object(py::float_(*v.interval->upper)) : py::object(py::none());
  return row;
}

py::dict participantDict(const analytics::Participant& p) {
  py::dict row;
  row["participant"] = p.pseudonym;
  row["group"] = p.group;
  row["arm"] = p.arm;
  row["site"] = p.site;
  row["experience"] = p.experience;
  row["consent"] = p.consent;
  return row;
}

/// Rows of the cohort, read without Python's lock, as a list of dicts.
template <class Row>
auto listOf(std::vector<Row> (CohortReader::*read)(), py::dict (*dictOf)(const Row&)) {
  return [read, dictOf](CohortReader& cohort) {
    std::vector<Row> rows;
    {
      const py::gil_scoped_release release;
      rows = (cohort.*read)();
    }
    py::list list;
    for (const Row& row : rows) list.append(dictOf(row));
    return list;
  };
}

}  // namespace

void bindCohort(py::module_& m) {
  py::class_<CohortReader>(m, "Cohort", "A cohort's database, opened for reading.")
      .def(py::init<const std::filesystem::path&>(), py::arg("path"), py::call_guard<py::gil_scoped_release>())
      .def("attempts", listOf(&CohortReader::attempts, attemptDict))
      .def("values", listOf(&CohortReader::values, cohortValueDict))
      .def("participants", listOf(&CohortReader::participants, participantDict));
  m.def("record_export", analytics::recordExport, py::arg("cohort"), py::arg("kind"), py::arg("target"),
        py::arg("attempts"), py::call_guard<py::gil_scoped_release>(),
        "Registers in a cohort an export of attempts to a file or folder, so that a withdrawal lists it.");
}

}  // namespace calot::python
