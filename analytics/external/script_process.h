// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

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

}  // namespace calot::analytics
