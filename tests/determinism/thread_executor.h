// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#ifndef __wasm__
#include <thread>
#endif

#include "sim/math/executor.h"
#include "sim/math/floating_point.h"

namespace calot {

/// The plainest executor of several threads: starts them for every batch and joins them at its end. For programs that
/// link `sim` alone; slow, and by its ever new threads a harsher test of thread independence than a pool.
class ThreadExecutor final : public Executor {
 public:
  /// @param threads how many work on a batch, the caller included; at least 1.
  explicit ThreadExecutor(unsigned threads) : threads_(std::max(1U, threads)) {}

  void run(std::size_t count, TaskRef task) override {
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
      const FloatingPointScope scope;
      for (std::size_t i = next++; i < count; i = next++) task(i);
    };
#ifdef __wasm__  // has no threads here: one does it all
    work();
#else
    std::vector<std::thread> others;
    for (std::size_t i = 1; i < std::min<std::size_t>(threads_, count); ++i) others.emplace_back(work);
    work();
    for (std::thread& other : others) other.join();
#endif
  }

 private:
  unsigned threads_;
};

}  // namespace calot
