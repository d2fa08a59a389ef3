// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace calot {

/// Exit codes of every command (docs/command-line.md).
enum class ExitCode : int {
  yes = 0,
  failure = 1,    ///< something inside went wrong (disk full, no memory)
  usage = 2,      ///< wrong use of the command line
  no = 3,         ///< the answer is no: diverged, invalid, falls short
  damaged = 4,    ///< damaged or unreadable input
  undecided = 5,  ///< this build cannot decide: another simulation version
};

/// Bad input or a failed operation, found at the edge. The message is one line that names file and place and says what
/// to do; main() prints it after "calot: " and exits with the code.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

}  // namespace calot
