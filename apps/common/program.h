// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "apps/common/exit_code.h"

namespace calot::apps {

/// One line on stderr, "calot: message". @return the code, for main()
int endWith(ExitCode code, const std::string& program, const std::string& message);

/// Body of main(): runs the body; an error that it throws is a line on stderr and an exit code.
int runProgram(const std::string& program, const std::function<int()>& body);

}  // namespace calot::apps
