// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/widget_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <QApplication>
#include <QFontMetricsF>
#include <QPainter>
#include <QPixmap>
#include <QStyleFactory>
#include <utility>

#include "recorder/base/errors.h"

namespace calot::gui {

QBoxLayout* parts::fill(QBoxLayout* layout, std::initializer_list<Item> items) {
  for (const Item& item : items) {
    if (item.label != nullptr) {
      auto* const label = new QLabel(item.label);
      label->setBuddy(item.widget);
      layout->addWidget(label);
    }
    if (item.widget != nullptr)
      layout->addWidget(item.widget, item.stretch);
    else if (item.layout != nullptr)
      layout->addLayout(item.layout, item.stretch);
    else if (item.stretch > 0)
      layout->addStretch(item.stretch);
    else
      layout->addSpacing(item.pixels);
  }
  return layout;
}

QFrame* parts::sheet(QLayout* layout) {
  auto* const made = named("sheet", new QFrame);
  made->setStyleSheet(
      "QFrame#sheet { background: palette(base); border: 1px solid palette(mid); border-radius: 6px; }");
  layout->setContentsMargins(18, 14, 18, 14);
  made->setLayout(layout);
  return made;
}

QPushButton* parts::primary(QPushButton* button) {
  embolden(button);
  button->setDefault(true);
  return button;
}

void parts::savePicture(QWidget& window, const QString& file) {
  QApplication::processEvents();
  if (!window.grab().save(file, "PNG"))
    throw Error(ErrorKind::failure, Where{file.toStdString()}, "cannot write the picture; does the folder exist?");
}

namespace theme {
namespace {

using analytics::Verdict;
using Role = QPalette::ColorRole;

constexpr double usualLine = 14.0;  // pixels of a line of the usual letters: 9 points at 96 dots an inch

/// Text and what is behind it.
constexpr std::array<std::pair<Role, Role>, 12> pairs{{
    {QPalette::WindowText, QPalette::Window},
    {QPalette::Text, QPalette::Base},
    {QPalette::Text, QPalette::AlternateBase},
    {QPalette::ButtonText, QPalette::Button},
    {QPalette::PlaceholderText, QPalette::Base},
    {QPalette::HighlightedText, QPalette::Highlight},
    {QPalette::ToolTipText, QPalette::ToolTipBase},
    {QPalette::Link, QPalette::Base},
    {QPalette::Link, QPalette::Window},
    {QPalette::LinkVisited, QPalette::Base},
    {QPalette::LinkVisited, QPalette::Window},
    {QPalette::BrightText, QPalette::Shadow},
}};

double luminance(const QColor& colour) {
  const auto linear = [](double c) { return c <= 0.03928 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  return 0.2126 * linear(colour.redF()) + 0.7152 * linear(colour.greenF()) + 0.0722 * linear(colour.blueF());
}

QColor over(const QColor& ink, const QColor& ground) {
  const double a = ink.alphaF();
  const auto mix = [a](double over, double under) { return static_cast<float>(a * over + (1.0 - a) * under); };
  return QColor::fromRgbF(mix(ink.redF(), ground.redF()), mix(ink.greenF(), ground.greenF()),
                          mix(ink.blueF(), ground.blueF()));
}

QColor towards(const QColor& from, const QColor& to, double share) {
  QColor part = to;
  part.setAlphaF(static_cast<float>(share));
  return over(part, from);
}

/// Moves one of both away from the other until they are apart: the ground of a selection, else the text.
void mend(QPalette& palette, QPalette::ColorGroup group, Role text, Role ground) {
  const bool moveGround = text == QPalette::HighlightedText;
  const QColor ink = over(palette.color(group, text), palette.color(group, ground));
  const QColor behind = palette.color(group, ground);
  const bool darker = moveGround ? luminance(behind) < luminance(ink) : luminance(behind) > 0.18;
  const QColor end = darker ? QColor(Qt::black) : QColor(Qt::white);
  constexpr int parts = 20;
  for (int part = 0; part <= parts; ++part) {
    const QColor moved = towards(moveGround ? behind : ink, end, static_cast<double>(part) / parts);
    if (contrast(moved, moveGround ? ink : behind) < leastContrast) continue;
    palette.setColor(group, moveGround ? ground : text, moved);
    return;
  }
}

/// @param letters of all texts, disabled or not, @param rest colours of single roles
QPalette paletteFrom(QRgb button, QRgb window, QRgb letters, QRgb disabled,
                     std::initializer_list<std::pair<Role, QRgb>> rest) {
  QPalette made{QColor(button), QColor(window)};
  for (const Role role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText, QPalette::ToolTipText})
    made.setColor(role, QColor(letters));
  for (const auto& [role, colour] : rest) made.setColor(role, QColor(colour));
  for (const Role role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText})
    made.setColor(QPalette::Disabled, role, QColor(disabled));
  return made;
}

QPalette darkPalette() {
  return paletteFrom(0x3a3d41, 0x25282b, 0xececec, 0x808488,
                     {{QPalette::Base, 0x1b1d1f},
                      {QPalette::AlternateBase, 0x24272a},
                      {QPalette::ToolTipBase, 0x303337},
                      {QPalette::PlaceholderText, 0xa8acb0},
                      {QPalette::Highlight, 0x1f5f8f},
                      {QPalette::HighlightedText, 0xffffff},
                      {QPalette::Link, 0x7cc4f0},
                      {QPalette::LinkVisited, 0xd0b0f0}});
}

QPalette lightPalette() {
  return paletteFrom(0xefefef, 0xefefef, 0x000000, 0x8c8c8c,
                     {{QPalette::Base, 0xffffff},
                      {QPalette::AlternateBase, 0xf5f5f5},
                      {QPalette::ToolTipBase, 0xffffe6},
                      {QPalette::PlaceholderText, 0x666666},
                      {QPalette::Highlight, 0x1f6fa8},
                      {QPalette::HighlightedText, 0xffffff}});
}

QColor either(QRgb onLight, QRgb onDark) { return QColor(dark() ? onDark : onLight); }

}  // namespace

QString wordOf(Choice choice) { return choice == Choice::light ? "light" : choice == Choice::dark ? "dark" : "system"; }

Choice choiceOf(const QString& word) {
  return word == "light" ? Choice::light : word == "dark" ? Choice::dark : Choice::system;
}

QPalette paletteOf(Choice choice) {
  static const QPalette system = QApplication::palette();  // before anything was changed
  QPalette made = choice == Choice::light ? lightPalette() : choice == Choice::dark ? darkPalette() : system;
  for (const QPalette::ColorGroup group : {QPalette::Active, QPalette::Inactive}) {
    for (const auto& [text, ground] : pairs) mend(made, group, text, ground);
  }
  return made;
}

void apply(Choice choice, int type) {
  static const QFont usual = QApplication::font();
  const QPalette made = paletteOf(choice);
  // Styles of desktops have colours of their own.
  if (choice != Choice::system) QApplication::setStyle(QStyleFactory::create("Fusion"));
  QApplication::setPalette(made);
  // Rings and boxes to be ticked are drawn in Base, which is no lighter than what is around it.
  QPalette ticked = made;
  if (luminance(made.color(QPalette::Base)) < luminance(made.color(QPalette::Text)))
    ticked.setColor(QPalette::Base, QColor(0x7a, 0x80, 0x86));
  for (const char* kind : {"QRadioButton", "QCheckBox"}) QApplication::setPalette(ticked, kind);
  QFont font = usual;
  const double factor = 0.01 * std::clamp(type, usualType / 2, largestType);
  if (font.pointSizeF() > 0.0)
    font.setPointSizeF(factor * font.pointSizeF());
  else
    font.setPixelSize(static_cast<int>(std::lround(factor * font.pixelSize())));
  QApplication::setFont(font);
}

double contrast(const QColor& a, const QColor& b) {
  const double l = luminance(a), m = luminance(b);
  return (std::max(l, m) + 0.05) / (std::min(l, m) + 0.05);
}

bool dark() {
  const QPalette now = QApplication::palette();
  return luminance(now.color(QPalette::Text)) > luminance(now.color(QPalette::Base));
}

double typeScale() { return QFontMetricsF(QApplication::font()).height() / usualLine; }
int inType(int pixels) { return static_cast<int>(std::lround(pixels * std::max(1.0, typeScale()))); }

QColor text() { return QApplication::palette().color(QPalette::Text); }
QColor surface() { return QApplication::palette().color(QPalette::Base); }
QColor muted() { return either(0x505050, 0xb8bcc0); }
QColor grid() { return either(0xe4e4e4, 0x3c4044); }
QColor first() { return either(0x0072b2, 0x56b4e9); }
QColor second() { return either(0xc05000, 0xf08c3c); }
QColor trouble() { return either(0xa04200, 0xf4a260); }

QColor ofVerdict(Verdict verdict) {
  if (verdict == Verdict::verified) return either(0x005a8e, 0x7cc4f0);
  if (verdict == Verdict::diverged) return trouble();
  return verdict == Verdict::damaged ? either(0x8b2a5e, 0xe9a0cf) : muted();
}

QIcon buttonIcon(QStyle::StandardPixmap picture) {
  const QIcon usual = QApplication::style()->standardIcon(picture);
  const QPalette now = QApplication::palette();
  QIcon made;
  for (const auto& [mode, group] :
       {std::pair{QIcon::Normal, QPalette::Active}, {QIcon::Disabled, QPalette::Disabled}}) {
    constexpr int side = 24;
    QPixmap pixmap = usual.pixmap(side, side);
    QPainter painter(&pixmap);
    painter.setCompositionMode(QPainter::CompositionMode_SourceIn);
    painter.fillRect(pixmap.rect(), now.color(group, QPalette::ButtonText));
    painter.end();
    made.addPixmap(pixmap, mode);
  }
  return made;
}

void setGround(QLabel& label, const QColor& ground, const QColor& ink) {
  QPalette own = label.palette();
  own.setColor(QPalette::Window, ground);
  own.setColor(QPalette::WindowText, ink);
  own.setColor(QPalette::Text, ink);
  label.setPalette(own);
  label.setAutoFillBackground(true);
  label.setMargin(4);
}

QSize windowSizeFor(const QSize& available) {
  constexpr QSize small(1366, 768), usual(1680, 1050);
  if (available.width() <= small.width() || available.height() <= small.height()) return available;
  return (available * 0.9).boundedTo(usual).expandedTo(small);
}

}  // namespace theme
}  // namespace calot::gui
