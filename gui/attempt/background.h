// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <QObject>
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

}  // namespace calot::gui
