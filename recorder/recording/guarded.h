// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace calot::recorder {

/// What a child process may take.
struct GuardLimits {
  std::chrono::seconds time{600};
  std::size_t memory = std::size_t{1} << 30U;  ///< beyond what its parent holds (bytes)
};

/// For reading a recording of this size from front to back: a minute, and a second for each of its megabytes.
GuardLimits readingLimits(const std::filesystem::path& file);

/// Runs a task in a child process and returns what it returned. An Error that the task throws is thrown here again;
/// another exception becomes an Error of kind failure. If the child crashes, takes longer than the limit (it is killed
/// then) or needs more memory, an Error of kind damaged says which, naming `what` (a file).
std::string runGuarded(const std::string& what, const std::function<std::string()>& task,
                       const GuardLimits& limits = {});

}  // namespace calot::recorder
