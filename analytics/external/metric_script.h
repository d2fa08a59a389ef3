// SPDX-License-Identifier: GPL-3.0-or-later
// A user's own metric: a Python script with NAME, VERSION, UNIT, BETTER and compute(attempt)
// (docs/how-to/own-metrics.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "recorder/base/errors.h"

namespace calot::analytics {

/// Resource limits of a script.
struct ScriptLimits {
  unsigned seconds = 60;         ///< of wall time
  std::size_t mebibytes = 2048;  ///< of address space beyond that of its input
};

/// How a script's process ended, and what it left.
struct ScriptEnd {
  enum class How : std::uint8_t { exited, signalled, late, printedTooMuch } how = How::exited;
  int number = 0;       ///< exit code or signal
  std::string answer;   ///< what it wrote to descriptor 3
  std::string printed;  ///< to standard output and error, at most maxPrinted bytes
};

/// Output limit of a script; it is killed beyond it.
inline constexpr std::size_t maxPrinted = 65536;

/// The Python that runs scripts: CALOT_PYTHON, or the system's, or the first in PATH.
std::string pythonProgram();

/// Runs a program until it ends or takes too much, and ends everything that it started. Its standard input is empty,
/// its folder `folder`, its environment a fixed one; it has no open file of this program. It may not start programs,
/// where the user is no superuser. @param inputBytes address space beyond the limit. @throws Error (failure) where it
/// cannot be started.
ScriptEnd runScript(const std::vector<std::string>& command, const std::filesystem::path& folder,
                    const ScriptLimits& limits, std::uint64_t inputBytes);

/// analytics/external/run_metric.py: what runs a user's script and writes one line of JSON to file descriptor 3. It
/// travels inside the program.
std::string_view metricRunner();

/// Receives a script's output, line by line.
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
