// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/greeting_page.h"

#include <QBoxLayout>
#include <QLabel>
#include <QPushButton>

namespace calot::gui {

GreetingPage::GreetingPage(QWidget* parent) : QWidget(parent), title_(new QLabel), text_(new QLabel) {
  auto* layout = new QVBoxLayout(this);
  layout->addStretch(1);
  QFont large = font();
  large.setPointSizeF(1.8 * large.pointSizeF());
  title_->setFont(large);
  title_->setAlignment(Qt::AlignHCenter);
  title_->setTextFormat(Qt::PlainText);
  text_->setObjectName("greeting");
  text_->setAlignment(Qt::AlignHCenter);
  text_->setWordWrap(true);
  text_->setTextFormat(Qt::PlainText);
  text_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  auto* open = new QPushButton("&Open a cohort database …");
  open->setObjectName("open");
  connect(open, &QPushButton::clicked, this, &GreetingPage::openRequested);
  layout->addWidget(title_);
  layout->addSpacing(12);
  layout->addWidget(text_);
  layout->addSpacing(18);
  layout->addWidget(open, 0, Qt::AlignHCenter);
  layout->addStretch(2);
  explainNoDatabase();
}

void GreetingPage::explainNoDatabase() {
  title_->setText("Welcome to Calot");
  text_->setText(
      "A cohort database holds attempts and their checkpoints.\nOpen one, or make one from recordings with\n\n"
      "calot assess recording.h5 --cohort cohort.db");
}

void GreetingPage::explainEmptyDatabase(const QString& fileName) {
  title_->setText("This cohort is still empty");
  text_->setText(
      fileName +
      " is a cohort database without attempts.\nAssess recordings into it; each is simulated again, verified "
      "and measured:\n\ncalot assess recording.h5 --cohort " +
      fileName + "\n\nThen choose View, Reload.");
}

}  // namespace calot::gui
