// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/value_report.h"

#include <algorithm>
#include <iterator>

#include "analytics/checkpoints/motion.h"
#include "recorder/base/errors.h"

namespace calot::apps {

const char* importedName(analytics::Imported imported) {
  switch (imported) {
    case analytics::Imported::added:
      return "added";
    case analytics::Imported::unchanged:
      return "unchanged";
    case analytics::Imported::extended:
      return "extended";
  }
  return "";
}

namespace {

nlohmann::ordered_json intervalJson(const analytics::ValueInterval& i) {
  using Json = nlohmann::ordered_json;
  if (!i.lower) return {{"lower", nullptr}, {"upper", nullptr}, {"reason", i.reason}};
  return Json{{"lower", *i.lower},           {"upper", *i.upper},           {"limit", i.limit()},
              {"step_effect", i.stepEffect}, {"mesh_effect", i.meshEffect}, {"constants_spread", i.constantsSpread}};
}

}  // namespace

nlohmann::ordered_json jsonOf(const std::vector<analytics::CheckpointValue>& values,
                              const std::vector<analytics::ValueInterval>& intervals) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const analytics::CheckpointValue& v : values) {
    nlohmann::ordered_json row = {{"name", v.name}, {"subject", v.subject}, {"version", v.version}};
    row["value"] = v.value ? nlohmann::ordered_json(*v.value) : nlohmann::ordered_json();
    row["unit"] = v.unit;
    row["origin"] = nameOf(v.origin);
    if (v.metric) row["sha256"] = v.metric->sha256;
    row["filter"] = v.filter;
    if (!v.value) {
      row["missing"] = nameOf(v.availability);
      row["reason"] = v.reason;
    }
    if (!v.note.empty()) row["note"] = v.note;
    if (v.coverage) row["coverage"] = *v.coverage;
    if (const analytics::ValueInterval* interval = analytics::findInterval(intervals, v))
      row["interval"] = intervalJson(*interval);
    list.push_back(row);
  }
  return list;
}

void addStoring(CLI::App& command, std::string& cohort, double& cutoff) {
  command.add_option("--cohort", cohort, "cohort database; made where there is none");
  command
      .add_option("--cutoff", cutoff,
                  "instead of --cohort: cut-off of the motion filter (Hz), 3, 6 or 10; shows, stores nothing")
      ->check([](const std::string& text) {
        const bool known = std::any_of(std::begin(analytics::motionCutoffs), std::end(analytics::motionCutoffs),
                                       [&](double hertz) { return text == std::to_string(static_cast<int>(hertz)); });
        return known ? std::string() : std::string("3, 6 or 10 is wanted");
      });
}

void checkStored(const std::string& cohort, double cutoff) {
  if (cohort.empty() && cutoff == 0.0)
    throw Error(ErrorKind::invalid, "--cohort: a database for the values is wanted (or --cutoff, to see them only)");
  if (!cohort.empty() && cutoff != 0.0) {
    throw Error(ErrorKind::invalid,
                "--cutoff: values of a cohort have one filter, 6 Hz; leave out --cohort to see those of another");
  }
}

}  // namespace calot::apps
