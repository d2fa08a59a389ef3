// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mutex>
#include <QThreadPool>

namespace calot::gui {

/// The way back from another thread to an object of the interface that may be gone by then, or no longer interested.
template <class Object>
class Link {
 public:
  explicit Link(Object& object) : object_(&object) {}
  /// Nothing passes from here on; waits for what is just passing.
  void cut() {
    const std::lock_guard lock(mutex_);
    object_ = nullptr;
  }
  /// Calls with the object, unless the link was cut. @param call is short: the object's thread may wait for it
  template <class Call>
  void pass(Call&& call) {
    const std::lock_guard lock(mutex_);
    if (object_ != nullptr) call(*object_);
  }
  /// Of the object's thread: whether the link still stands.
  [[nodiscard]] bool stands() const { return object_ != nullptr; }

 private:
  std::mutex mutex_;
  Object* object_;
};

/// Threads for what must not keep the interface waiting: reading recordings, ending players. Ends with the program.
inline QThreadPool& taskPool() {
  static QThreadPool pool;
  constexpr int maxTasks = 16;
  pool.setMaxThreadCount(maxTasks);
  return pool;
}

}  // namespace calot::gui
