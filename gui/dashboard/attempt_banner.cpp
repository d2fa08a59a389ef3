// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempt_banner.h"

#include <QBoxLayout>
#include <QLabel>

#include "gui/dashboard/words.h"

namespace calot::gui {

AttemptBanner::AttemptBanner(QWidget* parent) : QWidget(parent) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(3);
  const auto label = [&](const char* name) {
    auto* made = new QLabel;
    made->setObjectName(name);
    made->setWordWrap(true);
    made->setTextFormat(Qt::PlainText);
    made->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
    layout->addWidget(made);
    return made;
  };
  watermark_ = label("watermark");
  watermark_->setText(
      "SYNTHETIC — made by a performer. It shows that the pipeline works and says nothing about people.");
  watermark_->setStyleSheet("QLabel { background: #f0e442; color: #000000; font-weight: bold; padding: 4px; }");
  watermark_->hide();
  identity_ = label("identity");
  badge_ = label("badge");
}

void AttemptBanner::showAttempt(const analytics::AttemptRow& attempt) {
  QString text = QString("Attempt %1 · %2 · %3 · %4\n%5")
                     .arg(QString::fromStdString(attempt.uuid), operatorText(attempt), startText(attempt.startUtc),
                          outcomeText(attempt.outcome), QString::fromStdString(attempt.comparabilityKey));
  if (attempt.excluded) text += "\nExcluded from studies: " + QString::fromStdString(attempt.exclusionReason);
  identity_->setText(text);
  const Badge badge = badgeOf(attempt);
  badge_->setText(badge.text + ". " + QString(badge.explanation).replace('\n', ' '));
  badge_->setStyleSheet("QLabel { color: " + badge.colour.name() + "; }");
  watermark_->setVisible(attempt.synthetic);
}

void AttemptBanner::showText(const QString& text) {
  identity_->setText(text);
  badge_->clear();
  watermark_->hide();
}

}  // namespace calot::gui
