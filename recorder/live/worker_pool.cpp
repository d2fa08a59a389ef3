// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/live/worker_pool.h"

#include <algorithm>
#include <cassert>

#include "sim/math/floating_point.h"

namespace calot::recorder {
namespace {

constexpr std::uint64_t takenMask = 0xFFFFFFFFU;
constexpr std::uint64_t nextBatch = std::uint64_t{1} << 32U;

void relax() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

}  // namespace

WorkerPool::WorkerPool(unsigned threads) {
  const unsigned processors = std::max(1U, std::thread::hardware_concurrency());
  if (threads == 0) threads = processors;
  // With more threads than processors, a spinning thread keeps another from working.
  spins_ = threads <= processors ? 5000 : 0;
  workers_.reserve(threads - 1);
  for (unsigned i = 1; i < threads; ++i) workers_.emplace_back([this] { work(); });
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wakeWorkers_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void WorkerPool::run(std::size_t count, TaskRef task) {
  assert(count <= takenMask);
  [[maybe_unused]] const bool busy = running_.exchange(true, std::memory_order_acquire);
  assert(!busy && "WorkerPool::run from inside a task or from two threads at once");
  const FloatingPointScope scope;

  if (workers_.empty() || count <= 1) {
    for (std::size_t i = 0; i < count; ++i) task(i);
    running_.store(false, std::memory_order_release);
    return;
  }

  // No other thread accesses the batch here: all tasks of the last one are done.
  count_ = count;
  task_ = &task;
  finished_.store(0, std::memory_order_relaxed);
  const std::uint64_t batch = (ticket_.load(std::memory_order_relaxed) & ~takenMask) + nextBatch;
  ticket_.store(batch | count);
  // Sequentially consistent, as is the sleeper's registration before its last read of the ticket: one of the two sees
  // the other, so no wake-up is lost.
  if (sleepers_.load() > 0) {
    { const std::lock_guard lock(mutex_); }
    wakeWorkers_.notify_all();
  }

  const std::size_t own = takeTasks();
  if (finished_.fetch_add(own) + own != count) {
    const auto done = [&] { return finished_.load() == count; };
    for (int i = 0; i < spins_ && !done(); ++i) relax();
    if (!done()) {
      std::unique_lock lock(mutex_);
      callerSleeps_ = true;
      wakeCaller_.wait(lock, done);
      callerSleeps_ = false;
    }
  }
  running_.store(false, std::memory_order_release);
}

/// Runs tasks until none is left to take; returns how many it ran.
std::size_t WorkerPool::takeTasks() {
  std::size_t mine = 0;
  std::uint64_t ticket = ticket_.load(std::memory_order_acquire);
  while ((ticket & takenMask) != 0) {
    if (!ticket_.compare_exchange_weak(ticket, ticket - 1, std::memory_order_acq_rel, std::memory_order_acquire))
      continue;
    // A task of the current batch is ours and not done, so the batch stays as it is.
    (*task_)(count_ - static_cast<std::size_t>(ticket & takenMask));
    ++mine;
    ticket = ticket_.load(std::memory_order_acquire);
  }
  return mine;
}

bool WorkerPool::somethingToDo() const { return (ticket_.load() & takenMask) != 0 || stop_.load(); }

void WorkerPool::work() {
  const FloatingPointScope scope;
  for (;;) {
    for (int i = 0; i < spins_ && !somethingToDo(); ++i) relax();
    if (!somethingToDo()) {
      std::unique_lock lock(mutex_);
      ++sleepers_;
      wakeWorkers_.wait(lock, [this] { return somethingToDo(); });
      --sleepers_;
    }
    if (stop_.load()) return;
    if (const std::size_t mine = takeTasks(); mine > 0) {
      finished_.fetch_add(mine);
      if (callerSleeps_.load()) {
        { const std::lock_guard lock(mutex_); }
        wakeCaller_.notify_one();
      }
    }
  }
}

}  // namespace calot::recorder
