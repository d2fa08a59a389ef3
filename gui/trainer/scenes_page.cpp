// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/scenes_page.h"

#include <QBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>

namespace calot::gui {

ScenesPage::ScenesPage(QWidget* parent) : QWidget(parent), list_(new QListWidget), begin_(new QPushButton("&Begin")) {
  auto* const title = new QLabel("Welcome to the trainer");
  QFont large = font();
  large.setPointSizeF(1.8 * large.pointSizeF());
  title->setFont(large);
  auto* const text = new QLabel(
      "Choose what to practise. Every attempt is recorded; in practice you can pause, and go back to before a mistake "
      "and try again.");
  text->setWordWrap(true);
  list_->setObjectName("scenes");
  list_->setAccessibleName("Scenes");
  list_->setWordWrap(true);
  list_->setStyleSheet("QListWidget::item { padding: 8px; }");
  begin_->setObjectName("begin");
  begin_->setEnabled(false);
  begin_->setDefault(true);

  auto* const column = new QWidget;
  column->setMaximumWidth(900);
  auto* const inner = new QVBoxLayout(column);
  inner->addWidget(title);
  inner->addSpacing(6);
  inner->addWidget(text);
  inner->addSpacing(12);
  inner->addWidget(list_, 1);
  inner->addSpacing(6);
  inner->addWidget(begin_, 0, Qt::AlignRight);
  auto* const outer = new QHBoxLayout(this);
  outer->setContentsMargins(24, 32, 24, 32);
  outer->addStretch(1);
  outer->addWidget(column, 8);
  outer->addStretch(1);

  connect(list_, &QListWidget::itemActivated, this, &ScenesPage::choose);
  connect(list_, &QListWidget::currentRowChanged, this, [this](int row) { begin_->setEnabled(row >= 0); });
  connect(begin_, &QPushButton::clicked, this, &ScenesPage::choose);
}

void ScenesPage::setScenes(const std::vector<SceneChoice>& scenes) {
  list_->clear();
  for (const SceneChoice& scene : scenes) {
    auto* const item = new QListWidgetItem(QString::fromStdString(scene.name + "\n" + scene.summary), list_);
    item->setData(Qt::UserRole, QString::fromStdString(scene.file.string()));
  }
  if (!scenes.empty()) list_->setCurrentRow(0);
}

void ScenesPage::focusList() { list_->setFocus(); }

void ScenesPage::choose() {
  if (const QListWidgetItem* const item = list_->currentItem(); item != nullptr)
    emit chosen(item->data(Qt::UserRole).toString());
}

}  // namespace calot::gui
