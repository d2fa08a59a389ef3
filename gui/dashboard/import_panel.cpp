// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/import_panel.h"

#include <algorithm>
#include <QBoxLayout>
#include <QFileInfo>
#include <QLabel>
#include <QListWidget>
#include <QProgressBar>
#include <QPushButton>
#include <QTimer>

#include "gui/attempt/long_work.h"
#include "gui/attempt/theme.h"
#include "gui/attempt/widget_parts.h"

namespace calot::gui {

ImportPanel::ImportPanel(ImportQueue& queue, QWidget* parent)
    : QWidget(parent),
      queue_(queue),
      text_(parts::plainLabel("import-text", false)),
      bar_(parts::named("import-progress", new QProgressBar)),
      stop_(parts::named("import-stop", new QPushButton("Stop importin&g"))),
      results_(parts::named("import-results", new QListWidget)),
      tick_(new QTimer(this)) {
  results_->setAccessibleName("Results of the import");
  auto* row = new QHBoxLayout;
  row->addWidget(bar_, 1);
  row->addWidget(stop_);
  auto* layout = new QVBoxLayout(this);
  layout->addWidget(text_);
  layout->addLayout(row);
  layout->addWidget(results_, 1);
  connect(stop_, &QPushButton::clicked, &queue_, &ImportQueue::cancel);
  connect(&queue_, &ImportQueue::progressed, this, [this] { showProgress(); });
  connect(&queue_, &ImportQueue::fileDone, this, &ImportPanel::addResult);
  connect(&queue_, &ImportQueue::allDone, this, [this] { showProgress(); });
  connect(tick_, &QTimer::timeout, this, [this] { showProgress(); });
}

void ImportPanel::showProgress() {
  const bool busy = queue_.busy();
  if (busy && !clock_.isValid()) clock_.start();
  if (!busy) clock_.invalidate();
  double left = -1.0;
  if (busy && queue_.done() > 0)
    left = 1e-3 * static_cast<double>(clock_.elapsed()) / queue_.done() * (queue_.total() - queue_.done());
  stop_->setEnabled(busy);
  bar_->setRange(0, std::max(1, queue_.total()));
  bar_->setValue(queue_.done());
  const QString count = QString("%1 of %2 recordings").arg(queue_.done()).arg(queue_.total());
  if (!queue_.current().isEmpty())
    text_->setText(QString("%1 done. Simulating %2 again, %3 s so far … %4")
                       .arg(count, QFileInfo(queue_.current()).fileName())
                       .arg(queue_.seconds())
                       .arg(leftText(left)));
  else
    text_->setText(count + " done.");
  if (busy)
    tick_->start(1000);
  else
    tick_->stop();
}

void ImportPanel::addResult(const ImportResult& result) {
  auto* item = new QListWidgetItem(QFileInfo(result.file).fileName() + ": " + result.text);
  item->setToolTip(result.file);
  if (result.kind != ImportResult::Kind::stored) item->setForeground(theme::trouble());
  results_->addItem(item);
  results_->scrollToItem(item);
}

}  // namespace calot::gui
