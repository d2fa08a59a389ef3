// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "recorder/recording/reader.h"

namespace calot::recorder {

/// Opens an untrusted file in a child process, reads every row of it and computes its chain there: a crash or a hang of
/// the reading library ends the child only. @return the chain's verdict. @throws Error as Recording does, and damaged
/// when the child crashed or took too long. After it returned, opening the file in this process is safe.
ChainVerdict probe(const std::filesystem::path& path);

/// While one exists, probe() of this process forks small processes that were made beforehand instead of this one
/// (GuardProcesses): for who probes many short recordings. A second one at the same time does nothing.
class ProbeProcesses {
 public:
  /// @param count probes at a time; 0: one a processor. Has no effect while a recording is open in this process.
  explicit ProbeProcesses(unsigned count);
  ~ProbeProcesses();
  ProbeProcesses(const ProbeProcesses&) = delete;
  ProbeProcesses& operator=(const ProbeProcesses&) = delete;

 private:
  bool first_ = false;
};

}  // namespace calot::recorder
