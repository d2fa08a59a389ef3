// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/background.h"

#include <QMetaObject>
#include <utility>

#include "gui/view/thread_rank.h"

namespace calot::gui {

Background::Background(QObject* parent) : QObject(parent), thread_([this] { loop(); }) {}

Background::~Background() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void Background::run(Job job) {
  {
    const std::lock_guard lock(mutex_);
    next_ = std::move(job);
    ++newest_;
  }
  wake_.notify_one();
}

void Background::forget() {
  const std::lock_guard lock(mutex_);
  next_ = {};
  ++newest_;
}

void Background::loop() {
  stepBack(behindInterface);
  for (;;) {
    Job job;
    quint64 mine = 0;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return stop_ || next_; });
      if (stop_) return;
      job = std::exchange(next_, {});
      mine = newest_;
    }
    Completion answer = job();
    QMetaObject::invokeMethod(
        this,
        [this, mine, answer = std::move(answer)] {
          {
            const std::lock_guard lock(mutex_);
            if (mine != newest_) return;
          }
          answer();
        },
        Qt::QueuedConnection);
  }
}

}  // namespace calot::gui
