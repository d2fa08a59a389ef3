// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "sim/math/executor.h"

namespace calot::recorder {

/// An executor of several threads, the calling one among them. Made for a step that hands over dozens of short batches:
/// idle workers spin for some tens of microseconds before they sleep, and a batch allocates nothing.
///
/// Threads take the next task from a shared counter, so that results must not depend on which thread runs a task (see
/// Executor). Every task runs in the floating-point environment of the determinism contract.
///
/// One batch at a time: `run` from inside a task, or from two threads at once, is a programming error (asserted).
class WorkerPool final : public Executor {
 public:
  /// @param threads how many threads work on a batch, the caller included; 0 means one per processor.
  explicit WorkerPool(unsigned threads);
  ~WorkerPool() override;
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// @pre count < 2^32
  void run(std::size_t count, TaskRef task) override;

  [[nodiscard]] unsigned threadCount() const { return static_cast<unsigned>(workers_.size()) + 1; }

 private:
  void work();
  std::size_t takeTasks();
  [[nodiscard]] bool somethingToDo() const;

  // Ticket: the batch's number (upper half) and tasks not yet taken (lower half). Counting down lets a late worker see
  // that nothing is left before it reads a batch that may have been replaced.
  std::atomic<std::uint64_t> ticket_{0};
  std::atomic<std::size_t> finished_{0};  ///< tasks of this batch that are done
  std::atomic<unsigned> sleepers_{0};     ///< workers that sleep or are about to
  std::atomic<bool> callerSleeps_{false};
  std::atomic<bool> stop_{false};

  // The batch: written by the caller before it publishes the ticket, read only by those who took a task of it.
  std::size_t count_ = 0;
  const TaskRef* task_ = nullptr;

  std::atomic<bool> running_{false};  ///< guards the precondition
  int spins_ = 0;
  std::mutex mutex_;
  std::condition_variable wakeWorkers_, wakeCaller_;
  std::vector<std::thread> workers_;
};

}  // namespace calot::recorder
