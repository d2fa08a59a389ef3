// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/work_strip.h"

#include <QBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QTimer>

namespace calot::gui {

WorkStrip::WorkStrip(LongWork& work, QWidget* parent)
    : QWidget(parent),
      text_(new QLabel),
      bar_(new QProgressBar),
      cancel_(new QPushButton("Cance&l")),
      appear_(new QTimer(this)) {
  text_->setObjectName("work-text");
  text_->setTextFormat(Qt::PlainText);
  bar_->setObjectName("work-progress");
  bar_->setRange(0, 100);
  bar_->setAccessibleName("Progress of the work");
  cancel_->setObjectName("work-cancel");
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(text_, 1);
  layout->addWidget(bar_, 1);
  layout->addWidget(cancel_);
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
