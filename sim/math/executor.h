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

/// Runs tasks 0 .. count-1, each exactly once, in any order and on any thread, and returns when all are done.
/// What a task writes must not depend on which thread runs it or when: partitions and reduction orders are fixed by the
/// caller, so one thread and many give the same bits. Tasks must not throw.
class Executor {
 public:
  virtual ~Executor() = default;
  virtual void run(std::size_t count, TaskRef task) = 0;
};

/// The executor of one thread: the caller's.
class SerialExecutor final : public Executor {
 public:
  void run(std::size_t count, TaskRef task) override {
    for (std::size_t i = 0; i < count; ++i) task(i);
  }
};

}  // namespace calot
