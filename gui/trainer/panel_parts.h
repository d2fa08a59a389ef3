// SPDX-License-Identifier: GPL-3.0-or-later
// What the trainer's panel and its end page are made of.
#pragma once

#include <QLabel>
#include <QPushButton>

namespace calot::gui::parts {

/// A label without text that shows what it is given as it is, never as HTML.
inline QLabel* plainLabel(const char* name, bool wrap = true) {
  auto* const label = new QLabel;
  label->setObjectName(name);
  label->setTextFormat(Qt::PlainText);
  label->setWordWrap(wrap);
  return label;
}

inline QPushButton* button(const char* text, const char* name) {
  auto* const made = new QPushButton(text);
  made->setObjectName(name);
  made->setAutoDefault(true);  // Enter presses it
  return made;
}

/// Nothing to say takes no place.
inline void say(QLabel* label, const QString& text) {
  if (label->text() != text) label->setText(text);
  label->setVisible(!text.isEmpty());
}

}  // namespace calot::gui::parts
