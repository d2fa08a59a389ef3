// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "recorder/base/errors.h"

namespace calot::apps {

/// Exit codes of every program (docs/reference/command-line.md).
enum class ExitCode : int {
  yes = 0,
  failure = 1,    ///< something inside went wrong (disk full, no memory)
  usage = 2,      ///< wrong use of the command line
  no = 3,         ///< the answer is no: diverged, invalid, falls short
  damaged = 4,    ///< damaged or unreadable input
  undecided = 5,  ///< this build cannot decide: another simulation version
};

ExitCode codeOf(ErrorKind kind);

/// @param fault of one input; none: yes
ExitCode codeOf(const std::optional<ErrorKind>& fault);

/// Over many inputs: the first present of 1, 4, 3, 5, 0.
ExitCode worstOf(const std::vector<ExitCode>& codes);

}  // namespace calot::apps
