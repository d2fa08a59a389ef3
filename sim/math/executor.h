// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <type_traits>

namespace calot {

/// Reference to a callable `void(std::size_t)`; does not own it and never allocates.
class TaskRef {
 public:
  template <class F>
  requires(!std::is_same_v<std::remove_cvref_t<F>, TaskRef>)
      TaskRef(F&& f)  // NOLINT(google-explicit-constructor): a view, like string_view
      : object_(const_cast<void*>(static_cast<const void*>(&f))),
        call_([](void* o, std::size_t i) { (*static_cast<std::remove_reference_t<F>*>(o))(i); }) {}
  void operator()(std::size_t i) const { call_(object_, i); }

 private:
  void* object_;
  void (*call_)(void*, std::size_t);
};

/// Runs tasks 0 to count - 1, each exactly once, in any order and on any thread, and returns when all are done. Results
/// of a task must not depend on the thread or the time: the caller fixes partitions and reduction orders, so that any
/// number of threads gives the same bits. Tasks must not throw.
class Executor {
 public:
  virtual ~Executor() = default;
  virtual void run(std::size_t count, TaskRef task) = 0;
};

/// Runs all tasks on the caller's thread.
class SerialExecutor final : public Executor {
 public:
  void run(std::size_t count, TaskRef task) override {
    for (std::size_t i = 0; i < count; ++i) task(i);
  }
};

}  // namespace calot
