// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

namespace calot::gui {

/// Produces items in order on a separate thread, a few ahead of the consumer.
template <class Thing>
class LookAhead {
 public:
  /// @param make is called for 0 to count - 1, on the thread, until one throws or this is destroyed
  LookAhead(std::uint64_t count, std::function<Thing(std::uint64_t)> make)
      : thread_([this, count, make = std::move(make)](const std::stop_token& stop) { run(count, make, stop); }) {}

  /// Waits for the next item. Rethrows an exception of `make`. @pre fewer than `count` were taken
  Thing next() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return !ready_.empty() || fault_; });
    if (ready_.empty()) std::rethrow_exception(fault_);
    Thing thing = std::move(ready_.front());
    ready_.pop_front();
    lock.unlock();
    changed_.notify_all();
    return thing;
  }

 private:
  static constexpr std::size_t ahead = 4;

  void run(std::uint64_t count, const std::function<Thing(std::uint64_t)>& make, const std::stop_token& stop) {
    try {
      for (std::uint64_t k = 0; k < count; ++k) {
        Thing thing = make(k);
        std::unique_lock<std::mutex> lock(mutex_);
        if (!changed_.wait(lock, stop, [this] { return ready_.size() < ahead; }) || stop.stop_requested()) return;
        ready_.push_back(std::move(thing));
        lock.unlock();
        changed_.notify_all();
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      fault_ = std::current_exception();
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Thing> ready_;
  std::exception_ptr fault_;
  std::jthread thread_;  ///< last: it uses all of the above
};

}  // namespace calot::gui
