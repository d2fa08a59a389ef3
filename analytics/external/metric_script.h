// SPDX-License-Identifier: GPL-3.0-or-later
// A user's own metric: a Python script with NAME, VERSION, UNIT, BETTER and compute(attempt)
// (docs/how-to/own-metrics.md).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/external/script_process.h"
#include "recorder/base/errors.h"

namespace calot::analytics {

/// Where what a script prints goes, line by line.
using ScriptPrint = std::function<void(const std::string& script, const std::string& line)>;

/// A script that declared its metric. Its text was read once: what is hashed is what runs.
class MetricScript {
 public:
  /// Reads the script and runs it for its declarations. @throws Error (damaged) naming script and line where it cannot
  /// be read, fails, or declares what no metric is, such as the name of a checkpoint; Error (failure) without a Python
  /// that has NumPy.
  MetricScript(const std::filesystem::path& file, const ScriptLimits& limits, ScriptPrint print = {});

  [[nodiscard]] const std::string& file() const { return file_; }  ///< as it was named
  [[nodiscard]] const ExternalMetricRef& metric() const { return metric_; }

  /// Calls compute() on the attempt in `folder` (MetricInput). @param note of the value
  /// @return the value, or that it is not available with the script's reason
  /// @throws Error (damaged) where the script fails: it raises, returns what is no number, takes too long, too much
  /// memory, or prints too much.
  [[nodiscard]] CheckpointValue compute(const std::filesystem::path& folder, const std::string& note = "") const;

 private:
  std::string file_;
  std::vector<std::byte> text_;
  ScriptLimits limits_;
  ScriptPrint print_;
  ExternalMetricRef metric_;
};

/// @throws Error (invalid) where two scripts declare one name. Else as MetricScript.
std::vector<MetricScript> readMetricScripts(const std::vector<std::string>& files, const ScriptLimits& limits,
                                            const ScriptPrint& print = {});

/// Results of scripts for one attempt: values, and the errors of those that failed.
struct MetricOutcomes {
  std::vector<CheckpointValue> values;
  std::vector<Error> failures;
};
MetricOutcomes computeMetrics(const std::vector<MetricScript>& scripts, const std::filesystem::path& folder,
                              const std::string& note = "");

}  // namespace calot::analytics
