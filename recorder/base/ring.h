// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

namespace calot::recorder {

/// Lock-free queue of one producer and one consumer over a fixed number of slots; allocates in its constructor alone.
template <class T>
class Ring {
 public:
  /// @pre capacity > 0
  explicit Ring(std::size_t capacity) : slots_(capacity) {}

  /// Producer only. @returns false, with nothing done, where all slots are taken.
  bool push(const T& value) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == slots_.size()) return false;
    slots_[end % slots_.size()] = value;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }

  /// Consumer only. @returns false if there is nothing.
  bool pop(T& value) {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    value = slots_[begin % slots_.size()];
    begin_.store(begin + 1, std::memory_order_release);
    return true;
  }

 private:
  std::vector<T> slots_;
  alignas(64) std::atomic<std::size_t> begin_{0};  // values taken so far
  alignas(64) std::atomic<std::size_t> end_{0};    // values put so far
};

}  // namespace calot::recorder
