// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/compare_page.h"

#include <algorithm>
#include <exception>
#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QSignalBlocker>

#include "gui/attempt/words.h"
#include "gui/dashboard/comparison_chart.h"
#include "gui/dashboard/page_begin.h"
#include "gui/words/problem_words.h"

namespace calot::gui {

ComparePage::ComparePage(QWidget* parent) : QWidget(parent) {
  auto* layout = new QVBoxLayout(this);
  auto* upper = new QHBoxLayout;
  auto* lower = new QHBoxLayout;  // keys are long: they have a line of their own
  const auto addBox = [this](QHBoxLayout* row, const char* name, const char* text, int stretch) {
    auto* box = new QComboBox;
    box->setObjectName(name);
    box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    box->setMinimumContentsLength(14);
    auto* label = new QLabel(text);
    label->setBuddy(box);
    row->addWidget(label);
    row->addWidget(box, stretch);
    connect(box, &QComboBox::currentIndexChanged, this, [this] { redraw(); });
    return box;
  };
  figure_ = addBox(upper, "figure", "&Checkpoint", 3);
  groupBy_ = addBox(upper, "group-by", "&By", 1);
  key_ = addBox(lower, "key", "Comparable &within", 3);
  {
    const QSignalBlocker quiet(groupBy_);
    groupBy_->addItems({"group", "performer's profile", "participant"});
  }
  synthetic_ = new QCheckBox("&Synthetic attempts");
  synthetic_->setObjectName("synthetic");
  synthetic_->setChecked(true);
  connect(synthetic_, &QCheckBox::toggled, this, [this] { redraw(); });
  lower->addWidget(synthetic_);
  layout->addLayout(upper);
  layout->addLayout(lower);
  chart_ = new ComparisonChart;
  connect(chart_, &DotChart::attemptChosen, this, &ComparePage::attemptActivated);
  layout->addWidget(chart_, 1);
  setProperty(beginProperty, QVariant::fromValue<QObject*>(figure_));
  caption_ = new QLabel;
  caption_->setObjectName("caption");
  caption_->setTextFormat(Qt::PlainText);
  caption_->setWordWrap(true);
  layout->addWidget(caption_);
}

void ComparePage::setDocument(std::shared_ptr<const CohortDocument> document) {
  document_ = std::move(document);
  read_ = false;
  if (isVisible()) readValues();
}

void ComparePage::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  readValues();
}

void ComparePage::readValues() {
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
      takeValues(values);
    };
  });
}

void ComparePage::takeValues(std::shared_ptr<const FigureValues> values) {
  values_ = std::move(values);
  ready_ = true;
  keys_ = comparabilityKeysOf(document_->attempts());
  {
    const QSignalBlocker quietFigure(figure_), quietKey(key_), quietGroup(groupBy_);
    const QString figure = figure_->currentText(), key = key_->currentText();
    figure_->clear();
    if (values_) {
      for (const Figure& f : values_->figures()) figure_->addItem(figureTitle(f.name, f.subject));
    }
    key_->clear();
    for (const std::string& k : keys_) key_->addItem(QString::fromStdString(k));
    figure_->setCurrentIndex(std::max(0, figure_->findText(figure)));
    key_->setCurrentIndex(std::max(0, key_->findText(key)));
    // Nobody has a study group: then profiles tell more.
    bool grouped = false;
    for (const analytics::AttemptRow& attempt : document_->attempts()) grouped = grouped || !attempt.group.empty();
    groupBy_->setCurrentIndex(static_cast<int>(grouped ? GroupBy::group : GroupBy::profile));
  }
  redraw();
}

void ComparePage::redraw() {
  if (!document_ || !ready_) return;
  ComparisonRequest request;
  request.groupBy = static_cast<GroupBy>(groupBy_->currentIndex());
  request.includeSynthetic = synthetic_->isChecked();
  const int figure = figure_->currentIndex(), key = key_->currentIndex();
  if (figure < 0 || key < 0) {
    chart_->showComparison({}, "No checkpoint has a value yet");
    caption_->clear();
    return;
  }
  request.figure = values_->figures()[static_cast<std::size_t>(figure)];
  request.comparabilityKey = keys_[static_cast<std::size_t>(key)];
  const Comparison comparison = compare(document_->attempts(), values_->of(static_cast<std::size_t>(figure)), request);
  chart_->showComparison(comparison, figureTitle(request.figure.name, request.figure.subject));
  caption_->setText(QString::fromStdString(captionOf(comparison)));
}

}  // namespace calot::gui
