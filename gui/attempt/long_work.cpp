// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/long_work.h"

#include <cmath>
#include <exception>
#include <QMetaObject>
#include <QProgressBar>
#include <QPushButton>
#include <QTimer>
#include <utility>

#include "gui/attempt/widget_parts.h"
#include "gui/view/thread_rank.h"
#include "gui/words/problem_words.h"

namespace calot::gui {

void Background::run(Job job, Failed failed) {
  thread_.start([this, mine = ++newest_, job = std::move(job), failed = std::move(failed)] {
    if (mine != newest_) return;
    stepBack(behindInterface);
    Completion answer;
    try {
      answer = job();
    } catch (const std::exception& error) {
      answer = [failed, reason = QString::fromStdString(problemText(error))] { failed(reason); };
    }
    const auto complete = [this, mine, answer = std::move(answer)] {
      if (mine == newest_) answer();
    };
    QMetaObject::invokeMethod(this, complete, Qt::QueuedConnection);
  });
}

void LongWork::Control::progress(double share, const QString& what) {
  if (broken_) throw Broken{};
  {
    const std::lock_guard lock(mutex_);
    const int percent = static_cast<int>(100.0 * share);
    if (percent == percent_ && what == what_) return;
    percent_ = percent;
    what_ = what;
  }
  Link<LongWork>::post(back_, [share, what](LongWork& work) { work.take(share, what); });
}

LongWork::~LongWork() { end(); }

void LongWork::end() {
  if (!control_) return;
  control_->broken_ = true;
  control_->back_->cut();
  control_.reset();
}

void LongWork::start(Work work) {
  end();
  share_ = 0.0;
  clock_.start();
  control_ = std::make_shared<Control>();
  control_->back_ = std::make_shared<Link<LongWork>>(*this);
  taskPool().start([control = control_, work = std::move(work)] {
    stepBack(behindInterface);
    QString text;
    bool good = false;
    try {
      text = work(*control);
      good = true;
    } catch (const Broken&) {
      return;
    } catch (const std::exception& error) {
      text = QString::fromStdString(problemText(error));
    }
    Link<LongWork>::post(control->back_, [good, text](LongWork& object) {
      object.end();
      if (good)
        emit object.done(text);
      else
        emit object.failed(text);
    });
  });
}

void LongWork::cancel() {
  if (!control_) return;
  end();
  emit cancelled();
}

void LongWork::take(double share, const QString& what) {
  share_ = share;
  emit progressed(share, what);
}

double LongWork::secondsLeft() const {
  constexpr double least = 0.02;
  if (!busy() || share_ < least) return -1.0;
  return 1e-3 * static_cast<double>(clock_.elapsed()) * (1.0 - share_) / share_;
}

QString leftText(double seconds) {
  if (seconds < 0.0) return {};
  if (seconds < 60.0) return QString("about %1 s left").arg(std::max(1L, std::lround(seconds)));
  return QString("about %1 min left").arg(std::lround(seconds / 60.0));
}

WorkStrip::WorkStrip(LongWork& work)
    : text_(parts::plainLabel("work-text", false)),
      bar_(parts::named("work-progress", new QProgressBar)),
      cancel_(parts::named("work-cancel", new QPushButton("Cance&l"))),
      appear_(new QTimer(this)) {
  bar_->setRange(0, 100);
  bar_->setAccessibleName("Progress of the work");
  setLayout(parts::bare(parts::row({{text_, 1}, {bar_, 1}, cancel_})));
  hide();
  appear_->setSingleShot(true);
  connect(appear_, &QTimer::timeout, this, &QWidget::show);
  connect(cancel_, &QPushButton::clicked, &work, &LongWork::cancel);
  connect(&work, &LongWork::progressed, this, [this, &work](double share, const QString& what) {
    bar_->setValue(static_cast<int>(100.0 * share));
    const QString left = leftText(work.secondsLeft());
    text_->setText(left.isEmpty() ? what : what + ", " + left);
  });
  const auto end = [this] {
    appear_->stop();
    hide();
  };
  for (const auto ended : {&LongWork::done, &LongWork::failed}) connect(&work, ended, this, end);
  connect(&work, &LongWork::cancelled, this, end);
}

void WorkStrip::begin(const QString& what, int after) {
  text_->setText(what);
  bar_->setValue(0);
  if (after > 0 && !isVisible())
    appear_->start(after);
  else
    show();
}

}  // namespace calot::gui
