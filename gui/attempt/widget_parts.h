// SPDX-License-Identifier: GPL-3.0-or-later
// Building blocks of pages, panels and dialogs.
#pragma once

#include <initializer_list>
#include <QBoxLayout>
#include <QComboBox>
#include <QLabel>
#include <QPushButton>
#include <QScrollArea>

namespace calot::gui::parts {

/// The widget with its object name.
template <class Widget>
Widget* named(const char* name, Widget* widget) {
  widget->setObjectName(name);
  return widget;
}

/// A label that shows what it is given as it is, never as HTML.
inline QLabel* plainLabel(const char* name, bool wrap = true) {
  auto* const label = named(name, new QLabel);
  label->setTextFormat(Qt::PlainText);
  label->setWordWrap(wrap);
  return label;
}

inline void embolden(QWidget* widget) {
  QFont bold = widget->font();
  bold.setBold(true);
  widget->setFont(bold);
}

inline void enlarge(QWidget* widget, double factor) {
  QFont large = widget->font();
  large.setPointSizeF(factor * large.pointSizeF());
  widget->setFont(large);
}

/// Letters may be so large that not all of a page fits: it is scrolled up and down.
inline QScrollArea* scrolled(QWidget* page) {
  auto* const scroll = new QScrollArea;
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setWidgetResizable(true);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scroll->setWidget(page);
  return scroll;
}

inline QPushButton* button(const char* text, const char* name) {
  auto* const made = named(name, new QPushButton(text));
  made->setAutoDefault(true);  // Enter presses it
  return made;
}

/// A choice as wide as this number of letters, however long its entries are.
inline QComboBox* choice(const char* name, int letters) {
  auto* const made = named(name, new QComboBox);
  made->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  made->setMinimumContentsLength(letters);
  return made;
}

/// Puts a label, whose mnemonic leads to the field, and the field into a row.
template <class Widget>
Widget* labelled(QBoxLayout& row, const char* text, Widget* field, int stretch = 0) {
  auto* const label = new QLabel(text);
  label->setBuddy(field);
  row.addWidget(label);
  row.addWidget(field, stretch);
  return field;
}

/// A layout without margins: what is in it lines up with what is around it.
template <class Layout>
Layout* bare(QWidget* parent = nullptr) {
  auto* const made = new Layout(parent);
  made->setContentsMargins(0, 0, 0, 0);
  return made;
}

/// Puts widgets into a row or column.
inline void fill(QBoxLayout& layout, std::initializer_list<QWidget*> widgets) {
  for (QWidget* const widget : widgets) layout.addWidget(widget);
}

/// Hides a label that has nothing to say.
inline void say(QLabel* label, const QString& text) {
  if (label->text() != text) label->setText(text);
  label->setVisible(!text.isEmpty());
}

}  // namespace calot::gui::parts
