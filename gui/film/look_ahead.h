// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace calot::gui {

/// Produces items in order on a separate thread, a few ahead of the consumer.
template <class Thing>
class LookAhead {
 public:
  /// @param make is called for 0 to count - 1, on the thread, until one throws or this is destroyed
  LookAhead(std::uint64_t count, std::function<Thing(std::uint64_t)> make)
      : thread_([this, count, make = std::move(make)] { run(count, make); }) {}
  ~LookAhead() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  LookAhead(const LookAhead&) = delete;
  LookAhead& operator=(const LookAhead&) = delete;

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

  void run(std::uint64_t count, const std::function<Thing(std::uint64_t)>& make) {
    for (std::uint64_t k = 0; k < count; ++k) {
      try {
        Thing thing = make(k);
        std::unique_lock<std::mutex> lock(mutex_);
        changed_.wait(lock, [this] { return stopping_ || ready_.size() < ahead; });
        if (stopping_) return;
        ready_.push_back(std::move(thing));
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex_);
        fault_ = std::current_exception();
      }
      changed_.notify_all();
      const std::lock_guard<std::mutex> lock(mutex_);
      if (fault_) return;
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Thing> ready_;
  std::exception_ptr fault_;
  bool stopping_ = false;
  std::thread thread_;  ///< last: it uses all of the above
};

}  // namespace calot::gui
