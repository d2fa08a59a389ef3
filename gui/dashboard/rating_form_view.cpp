// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/rating_form_view.h"

#include <algorithm>
#include <QApplication>
#include <QButtonGroup>
#include <QGroupBox>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QRadioButton>

#include "gui/attempt/widget_parts.h"

namespace calot::gui {
namespace {

constexpr int blank = -1000;  // button of an item that is left blank: no form's score

QString scoreText(const analytics::RatingForm& form, int score) {
  const auto at = static_cast<std::size_t>(score - form.least);
  QString text = QString::number(score);
  if (at < form.words.size()) text += QString::fromUtf8(" – ") + QString::fromStdString(form.words[at]);
  return text;
}

/// Words of an anchor: a click on them is one on its button.
class AnchorLabel : public QLabel {
 public:
  AnchorLabel(const QString& text, QRadioButton* button) : QLabel(text), button_(button) {
    setTextFormat(Qt::PlainText);
    setWordWrap(true);
    setAlignment(Qt::AlignTop | Qt::AlignLeft);
  }

 protected:
  void mousePressEvent(QMouseEvent* event) override { event->accept(); }
  void mouseReleaseEvent(QMouseEvent* event) override {
    if (event->button() == Qt::LeftButton && rect().contains(event->position().toPoint())) button_->click();
  }

 private:
  QRadioButton* button_;
};

}  // namespace

RatingFormView::RatingFormView() {
  setObjectName("form-area");
  setWidgetResizable(true);
}

void RatingFormView::setForm(const analytics::RatingForm* form) {
  items_.clear();
  answers_.clear();
  auto* content = new QWidget;
  auto* layout = new QVBoxLayout(content);
  if (form != nullptr) {
    for (const analytics::FormSection& section : form->sections) {
      auto* box = new QGroupBox(QString::fromStdString(section.name));
      auto* boxLayout = new QVBoxLayout(box);
      for (const analytics::FormItem& item : section.items) addItem(*boxLayout, item, *form);
      layout->addWidget(box);
    }
  }
  layout->addStretch(1);
  // Keys go on to the form: what has the focus is about to be deleted.
  if (widget() != nullptr && widget()->isAncestorOf(QApplication::focusWidget())) setFocus(Qt::OtherFocusReason);
  setWidget(content);  // deletes the former one
}

void RatingFormView::addItem(QVBoxLayout& layout, const analytics::FormItem& item, const analytics::RatingForm& form) {
  auto* text = parts::plainLabel("");
  text->setText(QString::fromStdString(item.text));
  parts::embolden(text);
  layout.addWidget(text);
  auto* buttons = new QButtonGroup(text);
  // With anchors a line for each point of the scale; without, all points in one line.
  const bool anchored = std::ranges::any_of(item.anchors, [](const std::string& a) { return !a.empty(); });
  auto* points = new QGridLayout;
  const auto add = [&](int id, const QString& label, const QString& words) {
    auto* button = new QRadioButton(label);
    button->setObjectName(QString::fromStdString(item.key) + '=' + (id == blank ? "-" : QString::number(id)));
    button->setAccessibleName(QString::fromStdString(item.text) + ": " + label + (words.isEmpty() ? "" : ": " + words));
    buttons->addButton(button, id);
    const int at = static_cast<int>(buttons->buttons().size()) - 1;
    if (anchored)
      points->addWidget(button, at, 0, 1, id == blank ? 2 : 1, Qt::AlignTop | Qt::AlignLeft);
    else
      points->addWidget(button, 0, at);
    if (!words.isEmpty())
      points->addWidget(parts::named((item.key + "-anchor").c_str(), new AnchorLabel(words, button)), at, 1);
  };
  for (int score = form.least; score <= form.most; ++score) {
    const auto at = static_cast<std::size_t>(score - form.least);
    add(score, scoreText(form, score), at < item.anchors.size() ? QString::fromStdString(item.anchors[at]) : QString());
  }
  add(blank, "left blank", {});
  buttons->button(blank)->setToolTip("Nothing can be said");
  points->setColumnStretch(anchored ? 1 : points->columnCount(), 1);
  layout.addLayout(points);
  layout.addSpacing(6);
  items_.emplace_back(item.key, buttons);
  connect(buttons, &QButtonGroup::idClicked, this, [this, key = item.key](int id) {
    answers_[key] = id == blank ? std::nullopt : std::optional(id);
    emit answered();
  });
}

void RatingFormView::setAnswers(const FormAnswers& answers) {
  answers_.clear();
  for (const auto& [key, buttons] : items_) {
    // A group without a choice: exclusive ones keep theirs.
    buttons->setExclusive(false);
    for (QAbstractButton* button : buttons->buttons()) button->setChecked(false);
    buttons->setExclusive(true);
    const auto at = answers.find(key);
    if (at == answers.end()) continue;
    QAbstractButton* button = buttons->button(at->second.value_or(blank));
    if (button == nullptr) continue;  // a score of another scale
    button->setChecked(true);
    answers_[key] = at->second;
  }
}

void RatingFormView::keyPressEvent(QKeyEvent* event) {
  bool digit = false;
  const int id = event->text() == "-" ? blank : event->text().toInt(&digit);
  const auto focused = [](const auto& item) {
    return std::ranges::any_of(item.second->buttons(),
                               [](const QAbstractButton* button) { return button->hasFocus(); });
  };
  auto item = std::ranges::find_if(items_, focused);
  if (item == items_.end())
    item = std::ranges::find_if(items_, [this](const auto& i) { return !answers_.contains(i.first); });
  QAbstractButton* const button = item == items_.end() || (!digit && id != blank) ? nullptr : item->second->button(id);
  if (button == nullptr) {
    QScrollArea::keyPressEvent(event);
    return;
  }
  button->click();
  if (item + 1 != items_.end()) ++item;
  QAbstractButton* const checked = item->second->checkedButton();
  QAbstractButton* const next = checked != nullptr ? checked : item->second->buttons().front();
  next->setFocus(Qt::OtherFocusReason);
  ensureWidgetVisible(next);
}

}  // namespace calot::gui
