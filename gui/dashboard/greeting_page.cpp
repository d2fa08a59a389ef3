// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/greeting_page.h"

#include <QBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <utility>

#include "gui/attempt/widget_parts.h"

namespace calot::gui {

GreetingPage::GreetingPage(AssessProgram program, QWidget* parent)
    : QWidget(parent),
      program_(std::move(program)),
      title_(new QLabel),
      text_(parts::plainLabel("greeting")),
      import_(nullptr) {
  auto* layout = new QVBoxLayout(this);
  layout->addStretch(1);
  QFont large = font();
  large.setPointSizeF(1.8 * large.pointSizeF());
  title_->setFont(large);
  title_->setAlignment(Qt::AlignHCenter);
  title_->setTextFormat(Qt::PlainText);
  text_->setAlignment(Qt::AlignHCenter);
  text_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  auto* open = parts::named("open", new QPushButton("&Open a cohort database …"));
  connect(open, &QPushButton::clicked, this, &GreetingPage::openRequested);
  layout->addWidget(title_);
  layout->addSpacing(12);
  layout->addWidget(text_);
  layout->addSpacing(18);
  auto* fresh = parts::named("new", new QPushButton("&Make a new one …"));
  connect(fresh, &QPushButton::clicked, this, &GreetingPage::newRequested);
  import_ = parts::named("import-recordings", new QPushButton("&Import recordings …"));
  connect(import_, &QPushButton::clicked, this, &GreetingPage::importRequested);
  auto* buttons = new QHBoxLayout;
  buttons->addStretch(1);
  for (QPushButton* button : {import_, open, fresh}) buttons->addWidget(button);
  buttons->addStretch(1);
  layout->addLayout(buttons);
  layout->addStretch(2);
  explainNoDatabase();
}

void GreetingPage::explainNoDatabase() {
  title_->setText("Welcome to Calot");
  text_->setText(
      "A cohort database holds attempts and their checkpoints.\nOpen one, make a new one, or drop one here. On the "
      "command line:\n\n" +
      program_.typed("cohort.db"));
  import_->hide();
}

void GreetingPage::explainEmptyDatabase(const QString& fileName) {
  title_->setText("This cohort is still empty");
  text_->setText(
      fileName +
      " is a cohort database without attempts.\nImport recordings, or drop them here: each is simulated again, "
      "verified and measured. On the command line:\n\n" +
      program_.typed(fileName));
  import_->show();
}

}  // namespace calot::gui
