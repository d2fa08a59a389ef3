// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "recorder/recording/guarded.h"

namespace calot::recorder {

/// Processes that guard many tasks of a kind, each in a child of its own as runGuarded does. They are made when this
/// process is small, and stay so: forking one that holds a cohort and a scene costs several times what a recording of
/// half a second takes to re-simulate (docs/explanation/performance-details.md, "Short recordings").
class GuardProcesses {
 public:
  using Task = std::function<std::string(const std::string& file)>;

  /// @param count as many tasks can run at a time; further ones wait. None are made while an HDF5 file is open in this
  /// process: its descriptors would be closed in them.
  GuardProcesses(Task task, unsigned count);
  ~GuardProcesses();
  GuardProcesses(const GuardProcesses&) = delete;
  GuardProcesses& operator=(const GuardProcesses&) = delete;

  /// As runGuarded with this file as `what`. Where no process is left, the task is run by runGuarded itself.
  std::string run(const std::string& file, const GuardLimits& limits);

 private:
  struct Process {
    pid_t id = -1;
    int socket = -1;
  };

  Process begin();
  static void end(Process& process);

  Task task_;
  std::mutex lock_;
  std::condition_variable free_;
  std::vector<Process> idle_;
  unsigned busy_ = 0;
};

}  // namespace calot::recorder
