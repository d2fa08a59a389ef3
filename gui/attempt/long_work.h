// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <QThreadPool>
#include <QWidget>

class QLabel;
class QProgressBar;
class QPushButton;
class QTimer;

namespace calot::gui {

/// Work that would keep the interface waiting, on a thread of its own. A newer job replaces one that waits, and the
/// answer of one that was overtaken is dropped.
class Background : public QObject {
  Q_OBJECT
 public:
  using Completion = std::function<void()>;                   ///< called on the object's thread
  using Job = std::function<Completion()>;                    ///< called on the background's thread
  using Failed = std::function<void(const QString& reason)>;  ///< where a job threw; called on the object's thread

  Background() { thread_.setMaxThreadCount(1); }
  /// Waits for the job that is being done; its answer is dropped.
  ~Background() override { forget(); }
  void run(Job job, Failed failed);
  /// Drops the job that waits and the answer of the one that is being done.
  void forget() { ++newest_; }

 private:
  std::atomic<quint64> newest_ = 0;  ///< number of the newest job; changed on the object's thread
  QThreadPool thread_;               // last: it uses what is above
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
  /// Has the object's thread call with the object, unless the link is cut by then.
  template <class Call>
  static void post(const std::shared_ptr<Link>& link, Call call) {
    link->pass([&](Object& object) {
      QMetaObject::invokeMethod(
          &object,
          [link, call = std::move(call)]() mutable {
            if (link->stands()) call(*link->object_);
          },
          Qt::QueuedConnection);
    });
  }

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

/// Work that takes seconds, on a thread of its own: it reports how far it is, and can be broken off. One at a time.
class LongWork : public QObject {
  Q_OBJECT
 public:
  /// The worker's view of this object; any thread.
  class Control {
   public:
    /// May be called as often as the work likes: the interface hears of each percent once, and of every new text.
    /// @param share done, from 0 to 1 @throws Broken where it was broken off
    void progress(double share, const QString& what);
    [[nodiscard]] bool broken() const { return broken_; }

   private:
    friend class LongWork;
    std::atomic<bool> broken_ = false;
    std::shared_ptr<Link<LongWork>> back_;
    std::mutex mutex_;  ///< of what was last passed on
    int percent_ = -1;
    QString what_;
  };
  struct Broken {};
  /// Ends with what to say of it. @throws Error, or what Control throws
  using Work = std::function<QString(Control&)>;

  /// Breaks off what is being done, without waiting for it.
  ~LongWork() override;
  /// Cancels the present work and begins again.
  void start(Work work);
  void cancel();
  [[nodiscard]] bool busy() const { return control_ != nullptr; }
  /// Seconds till the end, by what is done so far; below 0: not known yet.
  [[nodiscard]] double secondsLeft() const;
  [[nodiscard]] double share() const { return share_; }

 signals:
  void progressed(double share, const QString& what);
  void done(const QString& text);
  void failed(const QString& reason);
  void cancelled();

 private:
  void take(double share, const QString& what);
  void end();

  std::shared_ptr<Control> control_;
  QElapsedTimer clock_;
  double share_ = 0.0;
};

/// "12 s", "about 2 min": what is left, or nothing where it is not known.
[[nodiscard]] QString leftText(double seconds);

/// How long work goes: what is being done, how far, what is left, and a button that breaks it off. Hidden in between.
class WorkStrip : public QWidget {
  Q_OBJECT
 public:
  /// @param work outlives this
  explicit WorkStrip(LongWork& work);
  /// @param after ms: shorter work shows nothing, so that a page does not jump
  void begin(const QString& what, int after = 0);

 private:
  QLabel* text_;
  QProgressBar* bar_;
  QPushButton* cancel_;
  QTimer* appear_;
};

}  // namespace calot::gui
