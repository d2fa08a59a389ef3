// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/figures_page.h"

#include <algorithm>
#include <exception>
#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QSignalBlocker>

#include "gui/attempt/figure_text.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/plot_view.h"
#include "gui/words/problem_words.h"

namespace calot::gui {

FiguresPage::FiguresPage(const char* captionName, QWidget* parent) : QWidget(parent), caption_(new QLabel(this)) {
  caption_->setObjectName(captionName);
  caption_->setTextFormat(Qt::PlainText);
  caption_->setWordWrap(true);
}

void FiguresPage::setDocument(std::shared_ptr<const CohortDocument> document) {
  document_ = std::move(document);
  read_ = ready_ = false;
  if (isVisible()) readValues();
}

void FiguresPage::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  readValues();
}

void FiguresPage::readValues() {
  if (read_ || !document_) return;
  read_ = true;
  ready_ = false;
  caption_->setText("Reading the values …");
  background_.run([this, document = document_]() -> Background::Completion {
    std::shared_ptr<const FigureValues> values;
    QString fault;
    try {
      values = document->figureValues();
    } catch (const std::exception& error) {
      fault = QString::fromStdString(problemText(error));
    }
    return [this, values, fault] {
      if (!fault.isEmpty()) emit problem(fault);
      values_ = values;
      ready_ = true;
      takeValues();
    };
  });
}

void FiguresPage::fillFigures(QComboBox* box) const {
  const QString chosen = box->currentText();
  box->clear();
  if (values_) {
    for (const Figure& f : values_->figures()) box->addItem(figureTitle(f.name, f.subject));
  }
  box->setCurrentIndex(std::max(0, box->findText(chosen)));
}

QComboBox* FiguresPage::addChoice(QHBoxLayout* row, const char* name, const char* text, int stretch) {
  auto* const box = parts::choice(name, 13);
  parts::labelled(*row, text, box, stretch);
  return box;
}

ComparePage::ComparePage(QWidget* parent) : FiguresPage("caption", parent) {
  auto* layout = new QVBoxLayout(this);
  auto* upper = new QHBoxLayout;
  auto* lower = new QHBoxLayout;  // keys are long: they have a line of their own
  figure_ = addChoice(upper, "figure", "&Checkpoint", 3);
  groupBy_ = addChoice(upper, "group-by", "&By", 1);
  key_ = addChoice(lower, "key", "Comparable &within", 3);
  groupBy_->addItems({"group", "performer's profile", "participant"});
  for (QComboBox* const box : {figure_, groupBy_, key_})
    connect(box, &QComboBox::currentIndexChanged, this, [this] { redraw(); });
  synthetic_ = parts::named("synthetic", new QCheckBox("&Synthetic attempts"));
  synthetic_->setChecked(true);
  connect(synthetic_, &QCheckBox::toggled, this, [this] { redraw(); });
  lower->addWidget(synthetic_);
  layout->addLayout(upper);
  layout->addLayout(lower);
  chart_ = new PlotView("comparison-chart", "Attempts by group");
  connect(chart_, &PlotView::attemptChosen, this, &ComparePage::attemptActivated);
  layout->addWidget(chart_, 1);
  setProperty(beginProperty, QVariant::fromValue<QObject*>(figure_));
  layout->addWidget(caption());
}

void ComparePage::takeValues() {
  keys_ = comparabilityKeysOf(document().attempts());
  {
    const QSignalBlocker quietFigure(figure_), quietKey(key_), quietGroup(groupBy_);
    fillFigures(figure_);
    const QString key = key_->currentText();
    key_->clear();
    for (const std::string& k : keys_) key_->addItem(QString::fromStdString(k));
    key_->setCurrentIndex(std::max(0, key_->findText(key)));
    // Nobody has a study group: then profiles tell more.
    bool grouped = false;
    for (const analytics::AttemptRow& attempt : document().attempts()) grouped = grouped || !attempt.group.empty();
    groupBy_->setCurrentIndex(static_cast<int>(grouped ? GroupBy::group : GroupBy::profile));
  }
  redraw();
}

void ComparePage::redraw() {
  if (!ready()) return;
  ComparisonRequest request;
  request.groupBy = static_cast<GroupBy>(groupBy_->currentIndex());
  request.includeSynthetic = synthetic_->isChecked();
  const int figure = figure_->currentIndex(), key = key_->currentIndex();
  if (figure < 0 || key < 0) {
    chart_->clear("No checkpoint has a value yet");
    caption()->clear();
    return;
  }
  request.figure = values()->figures()[static_cast<std::size_t>(figure)];
  request.comparabilityKey = keys_[static_cast<std::size_t>(key)];
  const Comparison comparison = compare(document().attempts(), values()->of(static_cast<std::size_t>(figure)), request);
  const QString title = figureTitle(request.figure.name, request.figure.subject);
  chart_->show(
      comparison.group.empty() ? title + ": nothing to show" : title,
      [comparison, name = title.toStdString()](const analytics::PlotFrame& frame) {
        return drawComparison(comparison, name, frame);
      },
      comparison.synthetic);
  caption()->setText(QString::fromStdString(captionOf(comparison)));
}

}  // namespace calot::gui
