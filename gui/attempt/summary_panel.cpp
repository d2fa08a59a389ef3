// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/summary_panel.h"

#include <QBoxLayout>
#include <QLabel>

#include "gui/attempt/figure_text.h"
#include "gui/attempt/widget_parts.h"

namespace calot::gui {

SummaryPanel::SummaryPanel(QWidget* parent) : QWidget(parent) {
  auto* layout = parts::bare<QHBoxLayout>(this);
  layout->setSpacing(16);
  auto* words = new QVBoxLayout;
  words->setSpacing(2);
  const auto label = [](const char* name, QBoxLayout& into, int stretch) {
    auto* made = parts::named(name, new QLabel);
    made->setWordWrap(true);
    made->setTextFormat(Qt::PlainText);
    made->setTextInteractionFlags(Qt::TextSelectableByMouse);
    into.addWidget(made, stretch);
    return made;
  };
  verdict_ = label("summary-verdict", *words, 0);
  parts::embolden(verdict_);
  criticalView_ = label("summary-critical-view", *words, 0);
  errors_ = label("summary-errors", *words, 0);
  words->addStretch(1);
  layout->addLayout(words, 1);
  figures_ = label("summary-figures", *layout, 1);
  figures_->setAlignment(Qt::AlignTop | Qt::AlignLeft);
}

void SummaryPanel::showSummary(const analytics::AttemptSummary& summary) {
  verdict_->setText(QString::fromStdString(summary.verdict));
  criticalView_->setText(QString::fromStdString(summary.criticalView));
  criticalView_->setVisible(!summary.criticalView.empty());
  errors_->setText(QString::fromStdString(summary.errors));
  QStringList lines;
  for (const analytics::KeyFigure& figure : summary.figures) lines += keyFigureText(figure);
  figures_->setText(lines.join('\n'));
  show();
}

QString keyFigureText(const analytics::KeyFigure& figure) {
  QStringList parts;
  for (const analytics::CheckpointValue& value : figure.values) {
    const QString subject = QString::fromStdString(value.subject);
    parts += subject.isEmpty() ? valueText(value) : subject + ' ' + valueText(value);
  }
  return QString::fromStdString(figure.title) + ": " + parts.join(", ");
}

}  // namespace calot::gui
