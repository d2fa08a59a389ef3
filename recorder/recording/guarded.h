// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace calot::recorder {

/// Runs a task in a child process and returns what it returned. An Error that the task throws is thrown here again;
/// another exception becomes an Error of kind failure. If the child crashes or takes longer than the limit it is killed
/// and an Error of kind damaged says so, naming `what` (a file).
std::string runGuarded(const std::string& what, const std::function<std::string()>& task,
                       std::chrono::seconds limit = std::chrono::seconds(600));

}  // namespace calot::recorder
