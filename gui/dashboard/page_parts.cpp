// SPDX-License-Identifier: GPL-3.0-or-later

#include "gui/dashboard/page_parts.h"

#include <QAbstractItemModel>
#include <QApplication>
#include <QBoxLayout>
#include <QEvent>
#include <QHeaderView>
#include <QLabel>
#include <QTableView>
#include <QTimer>
#include <QTreeView>

#include "gui/attempt/figure_text.h"
#include "gui/attempt/theme.h"
#include "gui/attempt/widget_parts.h"

namespace calot::gui {

QTableView* makeTable(QAbstractItemModel& model, const char* name, const char* spokenName) {
  auto* table = parts::named(name, new QTableView);
  table->setAccessibleName(spokenName);
  table->setModel(&model);
  table->setSelectionBehavior(QAbstractItemView::SelectRows);
  table->setSelectionMode(QAbstractItemView::SingleSelection);
  table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table->setAlternatingRowColors(true);
  table->setTabKeyNavigation(false);
  table->setWordWrap(false);
  table->verticalHeader()->hide();
  table->verticalHeader()->setDefaultSectionSize(table->fontMetrics().height() + 9);
  table->horizontalHeader()->setStretchLastSection(true);
  table->horizontalHeader()->setHighlightSections(false);
  table->horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  return table;
}

QTreeView* makeTree(QAbstractItemModel& model, const char* name, const char* spokenName) {
  auto* tree = parts::named(name, new QTreeView);
  tree->setAccessibleName(spokenName);
  tree->setModel(&model);
  tree->setSelectionBehavior(QAbstractItemView::SelectRows);
  tree->setEditTriggers(QAbstractItemView::NoEditTriggers);
  tree->setAlternatingRowColors(true);
  tree->setUniformRowHeights(true);
  tree->header()->setStretchLastSection(true);
  tree->header()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  return tree;
}

void setWidths(QTableView& table, std::initializer_list<int> widths) {
  int column = 0;
  for (const int width : widths) table.setColumnWidth(column++, theme::inType(width));
}

void setWidths(QTreeView& tree, std::initializer_list<int> widths) {
  int column = 0;
  for (const int width : widths) tree.setColumnWidth(column++, theme::inType(width));
}

void wrapWords(QTableView& table) {
  table.setWordWrap(true);
  table.verticalHeader()->setMinimumSectionSize(table.verticalHeader()->defaultSectionSize());
  // Once for all columns that change together, when they have changed.
  auto* later = new QTimer(&table);
  later->setSingleShot(true);
  later->setInterval(0);
  QObject::connect(later, &QTimer::timeout, &table, &QTableView::resizeRowsToContents);
  QObject::connect(table.model(), &QAbstractItemModel::modelReset, &table, &QTableView::resizeRowsToContents);
  QObject::connect(table.horizontalHeader(), &QHeaderView::sectionResized, later, [later] { later->start(); });
}

AttemptBanner::AttemptBanner(QWidget* parent) : QWidget(parent) {
  auto* layout = parts::bare<QHBoxLayout>(this);
  const auto label = [&](const char* name, int stretch) {
    auto* made = parts::named(name, new QLabel);
    made->setWordWrap(true);
    made->setTextFormat(Qt::PlainText);
    made->setTextInteractionFlags(Qt::TextSelectableByMouse);
    layout->addWidget(made, stretch);
    return made;
  };
  watermark_ = label("watermark", 0);
  watermark_->setText("SYNTHETIC — made by a performer");
  watermark_->setWordWrap(false);
  watermark_->setToolTip("It shows that the pipeline works and says nothing about people.");
  parts::embolden(watermark_);
  theme::setGround(*watermark_, QColor(0xf0, 0xe4, 0x42), Qt::black);
  watermark_->hide();
  identity_ = label("identity", 3);
  badge_ = label("badge", 0);
  badge_->setWordWrap(false);
}

void AttemptBanner::showAttempt(const analytics::AttemptRow& attempt) {
  QString text = QString("%1 · %2 · %3 · %4 · attempt %5")
                     .arg(operatorText(attempt), QString::fromStdString(attempt.scene), startText(attempt.startUtc),
                          outcomeText(attempt.outcome), QString::fromStdString(attempt.uuid).left(8));
  if (attempt.excluded) text += "\nExcluded from studies: " + QString::fromStdString(attempt.exclusionReason);
  identity_->setText(text);
  const Badge badge = badgeOf(attempt);
  const QString found = QString::fromStdString(attempt.verification.text);
  badge_->setText(found.isEmpty() ? badge.text : badge.text + ": " + found);
  badge_->setWordWrap(!found.isEmpty());
  badge_->setToolTip(badge.explanation + '\n' + QString::fromStdString(attempt.uuid) + '\n' +
                     QString::fromStdString(analytics::comparabilityWords(attempt.comparabilityKey)));
  verdict_ = attempt.verification.verdict;
  colourBadge();
  watermark_->setVisible(attempt.synthetic);
}

void AttemptBanner::makeNarrow() {
  watermark_->setText("SYNTHETIC");
  badge_->hide();  // the choice above says it
}

void AttemptBanner::colourBadge() {
  QPalette own = QApplication::palette();
  own.setColor(QPalette::WindowText, theme::ofVerdict(verdict_));
  badge_->setPalette(own);
}

void AttemptBanner::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::PaletteChange) colourBadge();
}

void AttemptBanner::showText(const QString& text) {
  identity_->setText(text);
  badge_->clear();
  watermark_->hide();
}

}  // namespace calot::gui
