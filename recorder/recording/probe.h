// SPDX-License-Identifier: GPL-3.0-or-later
// Reading untrusted files in child processes: a crash or a hang of the reading library ends the child only.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "recorder/base/child_process.h"
#include "recorder/base/errors.h"
#include "recorder/recording/reader.h"
#include "sim/math/fields.h"

namespace calot::recorder {

/// Opens a file in a child process, reads every row of it and computes its chain there. @return the chain's verdict.
/// @throws Error as Recording does, and damaged when the child crashed or took too long. After it returned, opening the
/// file in this process is safe.
ChainVerdict probe(const std::filesystem::path& path);

/// The same of its beginning: header, /status, events and the first step, which then are safe to read here.
void probeBeginning(const std::filesystem::path& path);

/// While one exists, probe() of this process forks small processes that were made beforehand instead of this one
/// (GuardProcesses): for who probes many short recordings, and for windows, which stand still while a process of their
/// size is copied. A second one at the same time does nothing.
class ProbeProcesses {
 public:
  /// @param count probes at a time; 0: one a processor. Has no effect while a recording is open in this process.
  /// @param window probeBeginning() and identify(), too
  explicit ProbeProcesses(unsigned count, bool window = false);
  ~ProbeProcesses();
  ProbeProcesses(const ProbeProcesses&) = delete;
  ProbeProcesses& operator=(const ProbeProcesses&) = delete;

 private:
  bool first_ = false;
};

struct GuardLimits {
  std::chrono::seconds time{600};              ///< of the processor: a busy machine makes no file a damaged one
  std::size_t memory = std::size_t{1} << 30U;  ///< beyond what its parent holds (bytes)
  std::chrono::seconds wall = 20 * time;       ///< after which nobody waits any longer
};

/// For reading a recording of this size from front to back: a minute, and a second for each of its megabytes.
GuardLimits readingLimits(const std::filesystem::path& file);

/// Runs a task in a child process and returns what it returned. An Error that the task throws is thrown here again;
/// another exception becomes an Error of kind failure. If the child crashes, takes more of the processor's time than
/// the limit or needs more memory, an Error of kind damaged says which, naming `what` (a file); if it does not answer
/// for want of a disk or a processor, one of kind failure does.
std::string runGuarded(const std::string& what, const std::function<std::string()>& task,
                       const GuardLimits& limits = {});

/// A record as bytes, by its list of fields (sim/math/fields.h), and back.
std::string packed(const auto& record) {
  std::vector<std::byte> bytes;
  ByteWriter(bytes).write(record);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
/// @return false where these are not the bytes of such a record: a process that a file has broken may send anything
[[nodiscard]] bool unpack(const std::string& bytes, auto& out) {
  ByteReader reader(std::as_bytes(std::span(bytes)));
  reader.read(out);
  return reader.complete();
}

/// runGuarded() of a task that returns a record.
auto guardedRecord(const std::string& what, const auto& task, const GuardLimits& limits = {}) {
  decltype(task()) record{};
  if (!unpack(runGuarded(
                  what, [&] { return packed(task()); }, limits),
              record))
    throw Error(ErrorKind::damaged, Where{what}, "the reading library failed on it; the file is damaged");
  return record;
}

/// A task over a file that this program's ProbeProcesses may know; returns a record as bytes (packed()).
using ProbeTask = std::string (*)(const std::string& file);
/// Runs it there if they do, and else as runGuarded() does.
std::string runProbe(ProbeTask task, const std::filesystem::path& path, const GuardLimits& limits);
/// The task of identify().
std::string readIdentity(const std::string& file);

/// Processes that guard many tasks of a kind, each in a child of its own as runGuarded does. They are made when this
/// process is small, and stay so: forking one that holds a cohort and a scene costs several times what a recording of
/// half a second takes to re-simulate (docs/explanation/performance-details.md, "Short recordings").
class GuardProcesses {
 public:
  using Task = std::function<std::string(const std::string& file)>;

  /// @param count as many tasks can run at a time; further ones wait. None are made while an HDF5 file is open in this
  /// process: its descriptors would be closed in them.
  GuardProcesses(Task task, unsigned count);

  /// As runGuarded with this file as `what`. Where no process is left, the task is run by runGuarded itself.
  std::string run(const std::string& file, const GuardLimits& limits);

 private:
  Task task_;
  std::mutex lock_;
  std::condition_variable free_;
  std::vector<ChildProcess> idle_;
  unsigned busy_ = 0;
};

}  // namespace calot::recorder
