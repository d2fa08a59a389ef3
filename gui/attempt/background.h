// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <QObject>
#include <QThreadPool>
#include <thread>

namespace calot::gui {

/// Work that would keep the interface waiting, on a thread of its own. A newer job replaces one that waits, and the
/// answer of one that was overtaken is dropped.
class Background : public QObject {
  Q_OBJECT
 public:
  using Completion = std::function<void()>;  ///< called on the object's thread
  using Job = std::function<Completion()>;   ///< called on the background's thread; must not throw

  explicit Background(QObject* parent = nullptr);
  /// Waits for the job that is being done; its answer is dropped.
  ~Background() override;
  void run(Job job);
  /// Drops the job that waits and the answer of the one that is being done.
  void forget();

 private:
  void loop();

  std::mutex mutex_;
  std::condition_variable wake_;
  Job next_;
  quint64 newest_ = 0;  ///< number of the newest job; changed on the object's thread
  bool stop_ = false;
  std::thread thread_;  // last: it uses what is above
};

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
  /// True while the link stands. Object's thread only.
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
