// SPDX-License-Identifier: GPL-3.0-or-later
// Values of recordings and of cohorts.
#include <algorithm>
#include <iterator>
#include <mutex>
#include <string>

#include "analytics/assess.h"
#include "analytics/checkpoints/registry.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/withdraw.h"
#include "python/bindings.h"
#include "recorder/words.h"

namespace py = pybind11;

namespace calot::python {

namespace {

/// A value with the keys of `calot assess` in its JSON form.
py::dict valueDict(const analytics::CheckpointValue& v) {
  return py::dict("name"_a = v.name, "subject"_a = v.subject, "version"_a = v.version, "value"_a = v.value,
                  "unit"_a = v.unit, "origin"_a = analytics::nameOf(v.origin), "filter"_a = v.filter,
                  "availability"_a = analytics::nameOf(v.availability), "reason"_a = v.reason, "note"_a = v.note,
                  "coverage"_a = v.coverage);
}

/// Judges a recording as `calot assess` does, and stores the values where a cohort is named.
analytics::JudgedRecording assess(const std::string& file, unsigned threads, double cutoff, bool apart,
                                  const std::optional<std::string>& cohort) {
  const bool known = std::find(std::begin(analytics::motionCutoffs), std::end(analytics::motionCutoffs), cutoff) !=
                     std::end(analytics::motionCutoffs);
  if (!known) throw Error(ErrorKind::invalid, "cutoff: 3, 6 or 10 Hz is wanted");
  if (cohort && cutoff != analytics::motionCutoff)
    throw Error(ErrorKind::invalid, "cutoff: values of a cohort have one filter, 6 Hz");
  analytics::AssessSettings settings{.threads = threads, .cutoff = cutoff};
  settings.engine.apart = apart;
  analytics::JudgedRecording judged = analytics::assessRecording(file, settings);
  if (cohort && judged.record) {
    analytics::CohortDatabase database(*cohort, analytics::CohortDatabase::Access::create);
    database.storeAttempt(*judged.record, judged.values);
  }
  return judged;
}

py::tuple assessed(const std::filesystem::path& file, unsigned threads, double cutoff, bool apart,
                   const std::optional<std::filesystem::path>& cohort) {
  const analytics::JudgedRecording judged = withoutLock([&] {
    const auto database = cohort ? std::optional<std::string>(cohort->string()) : std::nullopt;
    analytics::JudgedRecording result = assess(file.string(), threads, cutoff, apart, database);
    if (result.report.verdict != recorder::ReplayVerdict::undecided || result.values.empty())
      throwUnlessExact(result.report);
    return result;
  });
  py::list values;
  for (const analytics::CheckpointValue& v : judged.values) values.append(valueDict(v));
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

py::dict attemptDict(const analytics::AttemptRow& a) {
  return py::dict("attempt"_a = a.uuid, "parent"_a = a.parent, "participant"_a = a.participant, "group"_a = a.group,
                  "arm"_a = a.arm, "site"_a = a.site, "scene"_a = a.scene, "scene_major"_a = a.sceneMajor,
                  "scene_minor"_a = a.sceneMinor, "operator"_a = recorder::wordFor(a.operatorKind),
                  "profile"_a = a.profile, "profile_version"_a = a.profileVersion, "synthetic"_a = a.synthetic,
                  "mode"_a = recorder::wordFor(a.mode), "purpose"_a = a.purpose,
                  "outcome"_a = recorder::wordFor(a.outcome), "start_utc"_a = a.startUtc, "seed"_a = a.seed,
                  "device"_a = a.device, "station"_a = a.station, "simulation_version"_a = a.simulationVersion,
                  "key"_a = a.comparabilityKey, "file"_a = a.fileName, "complete"_a = a.complete,
                  "seconds"_a = static_cast<double>(a.steps) * a.stepSeconds,
                  "verdict"_a = analytics::nameOf(a.verification.verdict), "excluded"_a = a.excluded,
                  "withdrawn"_a = a.withdrawn, "tags"_a = a.tags);
}

py::dict cohortValueDict(const analytics::AttemptValue& v) {
  py::dict row = valueDict(v.value);
  const bool bounded = v.interval && v.interval->lower;
  row["attempt"] = v.attempt;
  row["lower"] = bounded ? v.interval->lower : std::nullopt;
  row["upper"] = bounded ? v.interval->upper : std::nullopt;
  return row;
}

py::dict participantDict(const analytics::Participant& p) {
  return py::dict("participant"_a = p.pseudonym, "group"_a = p.group, "arm"_a = p.arm, "site"_a = p.site,
                  "experience"_a = p.experience, "consent"_a = p.consent);
}

/// Rows of the cohort as a list of dicts.
template <class Read, class Row>
auto listOf(Read read, py::dict (*dictOf)(const Row&)) {
  return [read, dictOf](CohortReader& cohort) {
    const std::vector<Row> rows = withoutLock([&] {
      const std::lock_guard lock(cohort.mutex);
      return read(cohort.database);
    });
    py::list list;
    for (const Row& row : rows) list.append(dictOf(row));
    return list;
  };
}

}  // namespace

void bindCohort(py::module_& m) {
  m.def("assess", assessed, "path"_a, "threads"_a, "cutoff"_a, "apart"_a, "cohort"_a);
  m.def("checkpoints", checkpoints, "What is known of every checkpoint.");
  py::class_<CohortReader>(m, "Cohort", "A cohort's database, opened for reading.")
      .def(py::init<const std::filesystem::path&>(), "path"_a, py::call_guard<py::gil_scoped_release>())
      .def("attempts", listOf([](const auto& d) { return d.listAttempts(); }, attemptDict))
      .def("values", listOf([](const auto& d) { return d.allValues(); }, cohortValueDict))
      .def("participants", listOf([](const auto& d) { return d.participants(); }, participantDict));
  m.def("record_export", analytics::recordExport, "cohort"_a, "kind"_a, "target"_a, "attempts"_a,
        py::call_guard<py::gil_scoped_release>(),
        "Registers in a cohort an export of attempts to a file or folder, so that a withdrawal lists it.");
}

}  // namespace calot::python
