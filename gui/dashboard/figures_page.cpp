// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/figures_page.h"

#include <algorithm>
#include <exception>
#include <QBoxLayout>
#include <QComboBox>
#include <QLabel>

#include "gui/attempt/words.h"
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
  auto* const box = new QComboBox;
  box->setObjectName(name);
  box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  box->setMinimumContentsLength(13);
  auto* const label = new QLabel(text);
  label->setBuddy(box);
  row->addWidget(label);
  row->addWidget(box, stretch);
  return box;
}

}  // namespace calot::gui
