// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <iterator>

#include "analytics/assess.h"
#include "analytics/checkpoints/registry.h"
#include "python/bindings.h"
#include "python/errors.h"
#include "python/value_rows.h"

namespace py = pybind11;

namespace calot::python {

namespace {

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
  analytics::JudgedRecording judged;
  {
    const py::gil_scoped_release release;
    judged = assess(file.string(), threads, cutoff, apart,
                    cohort ? std::optional<std::string>(cohort->string()) : std::nullopt);
    if (judged.report.verdict != recorder::ReplayVerdict::undecided || judged.values.empty())
      throwUnlessExact(judged.report);
  }
  py::list values;
  for (const analytics::CheckpointValue& v : judged.values) values.append(valueDict(v));
  return py::make_tuple(reportOf(judged.report), values);
}

py::list checkpoints() {
  py::list list;
  for (const analytics::CheckpointEntry& entry : analytics::checkpointRegistry()) {
    const analytics::CheckpointDefinition& d = entry.definition;
    py::dict row;
    row["name"] = d.name;
    row["title"] = d.title;
    row["unit"] = d.unit;
    row["version"] = d.version;
    row["direction"] = analytics::nameOf(d.direction);
    row["aggregation"] = analytics::nameOf(d.aggregation);
    row["definition"] = d.definition;
    list.append(row);
  }
  return list;
}

}  // namespace

void bindAssess(py::module_& m) {
  m.def("assess", assessed, py::arg("path"), py::arg("threads"), py::arg("cutoff"), py::arg("apart"),
        py::arg("cohort"));
  m.def("checkpoints", checkpoints, "What is known of every checkpoint.");
}

}  // namespace calot::python
