// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/metric_options.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "apps/calot/environment.h"
#include "apps/common/advice.h"
#include "recorder/base/errors.h"

namespace calot::apps {

CLI::Option* addMetrics(CLI::App& command, MetricOptions& options) {
  CLI::Option* metric =
      command
          .add_option("--metric", options.files,
                      "a Python script whose compute(attempt) gives a metric of your own; it runs with your rights")
          ->type_size(1)
          ->allow_extra_args(false);
  command.add_option("--metric-seconds", options.limits.seconds, "what a script may take for one attempt (s)")
      ->check(CLI::Range(1U, 86400U))
      ->needs(metric)
      ->capture_default_str();
  command.add_option("--metric-memory", options.limits.mebibytes, "memory of a script, beyond its input (MiB)")
      ->check(CLI::Range(256U, 1048576U))
      ->needs(metric)
      ->capture_default_str();
  return metric;
}

std::vector<analytics::MetricScript> readMetrics(const MetricOptions& options) {
  return analytics::readMetricScripts(
      options.files, options.limits,
      [](const std::string& script, const std::string& line) { fmt::print(stderr, "{}: {}\n", script, line); });
}

void checkMetrics(const std::vector<analytics::MetricScript>& metrics, const analytics::CohortDatabase& database) {
  for (const analytics::MetricScript& script : metrics) {
    try {
      database.checkMetric(*script.metric());
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::refused) throw;
      throw Error(e.kind(), Where{script.file()}, e.fault(), e.remedies());
    }
  }
}

void checkMetrics(const std::vector<analytics::MetricScript>& metrics, const std::string& cohort) {
  if (metrics.empty() || !std::filesystem::exists(cohort)) return;
  checkMetrics(metrics, analytics::CohortDatabase(cohort, analytics::CohortDatabase::Access::write));
}

ExitCode reportFailures(const analytics::MetricOutcomes& outcomes, const std::string& attempt) {
  std::vector<ExitCode> codes{ExitCode::yes};
  for (const Error& e : outcomes.failures) {
    Progress::erase();
    fmt::print(stderr, "calot: {} (of {}; no value of it is stored)\n", messageOf(e), attempt);
    codes.push_back(codeOf(e.kind()));
  }
  return worstOf(codes);
}

nlohmann::ordered_json failuresJson(const analytics::MetricOutcomes& outcomes) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Error& e : outcomes.failures) list.push_back(messageOf(e));
  return list;
}

}  // namespace calot::apps
