// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/verdict_card.h"

#include <QLabel>
#include <QPushButton>

#include "gui/attempt/widget_parts.h"

namespace calot::gui {
namespace {

struct SafetyWords {
  const char *sign, *words;
};

SafetyWords wordsOf(AttemptSummary::Safety safety) {
  switch (safety) {
    case AttemptSummary::Safety::notSafe:
      return {"✕", "Not safe"};
    case AttemptSummary::Safety::noCriticalError:
      return {"✓", "No critical error"};
    case AttemptSummary::Safety::notAssessed:
      break;
  }
  return {"?", "Safety not assessed"};
}

QColor colourOf(AttemptSummary::Safety safety) {
  switch (safety) {
    case AttemptSummary::Safety::notSafe:
      return theme::trouble();
    case AttemptSummary::Safety::noCriticalError:
      return theme::ofVerdict(analytics::Verdict::verified);
    case AttemptSummary::Safety::notAssessed:
      break;
  }
  return theme::muted();
}

/// "Critical: cystic duct left open, 1:40.2" as a link to its moment.
QString linkTo(const analytics::ErrorLine& error) {
  QString severity = analytics::nameOf(error.severity);
  severity[0] = severity[0].toUpper();
  const QString words = QString::fromStdString(error.counted() + (error.count > 1 ? ", worst at " : ", ") +
                                               analytics::timeText(error.time))
                            .toHtmlEscaped();
  return QString("%1: <a href=\"%2\">%3</a>").arg(severity).arg(error.time, 0, 'f', 3).arg(words);
}

}  // namespace

VerdictCard::VerdictCard()
    : safety_(parts::plainLabel("safety")),
      verdict_(parts::selectableLabel("summary-verdict")),
      criticalView_(parts::selectableLabel("summary-critical-view")),
      errors_(parts::named("summary-errors", new QLabel)),
      show_(parts::button("&Show it", "show-gravest")) {
  parts::embolden(safety_);
  parts::enlarge(safety_, 1.5);
  errors_->setTextFormat(Qt::RichText);
  errors_->setWordWrap(true);
  errors_->setTextInteractionFlags(Qt::TextBrowserInteraction);
  show_->setToolTip("Go to the moment of the gravest error");
  show_->hide();
  QBoxLayout* const rows =
      parts::bare(parts::column({parts::row({{safety_, 1}, show_}), verdict_, criticalView_, errors_}));
  rows->setSpacing(3);
  setLayout(rows);
  connect(errors_, &QLabel::linkActivated, this, [this](const QString& link) { emit timeChosen(link.toDouble()); });
  connect(show_, &QPushButton::clicked, this, [this] { emit timeChosen(gravest_); });
}

void VerdictCard::showSummary(const AttemptSummary& summary) {
  const auto [sign, words] = wordsOf(summary.safety);
  safety_->setText(QString("%1 %2").arg(sign, words));
  QPalette own = palette();
  own.setColor(QPalette::WindowText, colourOf(summary.safety));
  safety_->setPalette(own);
  verdict_->setText(QString::fromStdString(summary.verdict));
  parts::say(criticalView_, QString::fromStdString(summary.criticalView));
  QStringList lines;
  for (const std::string& sentence : summary.errors) lines += QString::fromStdString(sentence).toHtmlEscaped();
  errors_->setText(lines.join("<br>"));
  show_->hide();
  show();
}

void VerdictCard::showErrors(const std::vector<analytics::ErrorLine>& errors) {
  if (errors.empty()) return;
  QStringList lines;
  std::size_t minor = 0;
  for (const analytics::ErrorLine& error : errors) {
    if (error.severity == Severity::minor)
      minor += error.count;
    else
      lines += linkTo(error);
  }
  if (minor > 0)
    lines += QString("%1 minor %2, among the events below").arg(minor).arg(minor == 1 ? "error" : "errors");
  errors_->setText(lines.join("<br>"));
  gravest_ = errors.front().time;
  show_->setText("&Show " + QString::fromStdString(analytics::timeText(gravest_)));
  show_->setVisible(true);
}

}  // namespace calot::gui
