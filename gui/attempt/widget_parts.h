// SPDX-License-Identifier: GPL-3.0-or-later
// Building blocks of pages, panels and dialogs; then light and dark, and how large letters are. All colours of text in
// these windows keep WCAG 2.1's contrast of level AA to what is behind them.
#pragma once

#include <initializer_list>
#include <QBoxLayout>
#include <QColor>
#include <QComboBox>
#include <QIcon>
#include <QLabel>
#include <QPalette>
#include <QPushButton>
#include <QScrollArea>
#include <QSize>
#include <QString>
#include <QStyle>

#include "analytics/cohort/cohort_database.h"

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

/// The same, whose words can be selected and copied.
inline QLabel* selectableLabel(const char* name) {
  auto* const label = plainLabel(name);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
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

/// Element of a row or a column: a widget or another layout, or a field behind a label whose mnemonic leads to it;
/// each with its stretch factor.
struct Item {
  Item(QWidget* shown, int share = 0) : widget(shown), stretch(share) {}
  Item(QLayout* shown, int share = 0) : layout(shown), stretch(share) {}
  Item(const char* text, QWidget* field, int share = 0) : label(text), widget(field), stretch(share) {}

  const char* label = nullptr;
  QWidget* widget = nullptr;
  QLayout* layout = nullptr;
  int stretch, pixels = 0;
};
/// Empty space that grows.
inline Item spring(int share = 1) { return {static_cast<QWidget*>(nullptr), share}; }
/// Empty space of a fixed size.
inline Item space(int pixels) {
  Item made(static_cast<QWidget*>(nullptr));
  made.pixels = pixels;
  return made;
}

/// The layout with these items at its end.
QBoxLayout* fill(QBoxLayout* layout, std::initializer_list<Item> items);
inline QBoxLayout* row(std::initializer_list<Item> items) { return fill(new QHBoxLayout, items); }
inline QBoxLayout* column(std::initializer_list<Item> items) { return fill(new QVBoxLayout, items); }

/// The layout without margins: what is in it lines up with what is around it.
template <class Layout>
Layout* bare(Layout* layout) {
  layout->setContentsMargins(0, 0, 0, 0);
  return layout;
}
/// A widget of such a layout.
inline QWidget* boxed(QLayout* layout) {
  auto* const made = new QWidget;
  made->setLayout(bare(layout));
  return made;
}

/// A sheet of paper on a page: what belongs together, on a ground and in a frame of its own.
QFrame* sheet(QLayout* layout);
/// The button with what is most likely wanted next.
QPushButton* primary(QPushButton* button);

/// Writes a PNG of what a window shows. @throws calot::Error (failure)
void savePicture(QWidget& window, const QString& file);

/// Hides a label that has nothing to say.
inline void say(QLabel* label, const QString& text) {
  if (label->text() != text) label->setText(text);
  label->setVisible(!text.isEmpty());
}

}  // namespace calot::gui::parts

namespace calot::gui::theme {

enum class Choice { system, light, dark };
[[nodiscard]] QString wordOf(Choice choice);              ///< "system", "light", "dark"
[[nodiscard]] Choice choiceOf(const QString& word);       ///< system for any other word
inline constexpr int usualType = 100, largestType = 200;  ///< per cent

/// Dresses the whole application. @param type per cent of the system's size of letters
void apply(Choice choice, int type);
/// The palette of a choice, each text role mended to leastContrast.
[[nodiscard]] QPalette paletteOf(Choice choice);

inline constexpr double leastContrast = 4.5;
/// (L1 + 0.05) / (L2 + 0.05) of the relative luminances, the lighter above (WCAG 2.1, 1.4.3): 1 to 21.
[[nodiscard]] double contrast(const QColor& a, const QColor& b);

/// True if text is lighter than its background.
[[nodiscard]] bool dark();
/// A length that was chosen for letters of the usual size, for those that there are.
[[nodiscard]] int inType(int pixels);
[[nodiscard]] double typeScale();

// Colours on QPalette::Base.
[[nodiscard]] QColor text();
[[nodiscard]] QColor muted();
[[nodiscard]] QColor surface();
[[nodiscard]] QColor grid();
[[nodiscard]] QColor first();    ///< lines and marks: left hand, people
[[nodiscard]] QColor second();   ///< right hand, performers, errors
[[nodiscard]] QColor trouble();  ///< text of what went wrong
[[nodiscard]] QColor ofVerdict(analytics::Verdict verdict);

/// A standard picture of the style in the colour of letters on buttons.
[[nodiscard]] QIcon buttonIcon(QStyle::StandardPixmap picture);
/// A label that stands out on a ground of its own, with this text on it.
void setGround(QLabel& label, const QColor& ground, const QColor& ink);

/// Initial size of a window for the available screen: most of it; all of a small one.
[[nodiscard]] QSize windowSizeFor(const QSize& available);

}  // namespace calot::gui::theme
