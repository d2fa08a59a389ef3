// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/theme.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <QApplication>
#include <QFontMetricsF>
#include <QLabel>
#include <QPainter>
#include <QPixmap>
#include <QStyle>
#include <QStyleFactory>
#include <utility>

namespace calot::gui::theme {
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

QPalette darkPalette() {
  QPalette made(QColor(0x3a, 0x3d, 0x41), QColor(0x25, 0x28, 0x2b));
  const QColor letters(0xec, 0xec, 0xec), ground(0x1b, 0x1d, 0x1f);
  for (const Role role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText, QPalette::ToolTipText})
    made.setColor(role, letters);
  made.setColor(QPalette::Base, ground);
  made.setColor(QPalette::AlternateBase, QColor(0x24, 0x27, 0x2a));
  made.setColor(QPalette::ToolTipBase, QColor(0x30, 0x33, 0x37));
  made.setColor(QPalette::PlaceholderText, QColor(0xa8, 0xac, 0xb0));
  made.setColor(QPalette::Highlight, QColor(0x1f, 0x5f, 0x8f));
  made.setColor(QPalette::HighlightedText, Qt::white);
  made.setColor(QPalette::Link, QColor(0x7c, 0xc4, 0xf0));
  made.setColor(QPalette::LinkVisited, QColor(0xd0, 0xb0, 0xf0));
  for (const Role role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText})
    made.setColor(QPalette::Disabled, role, QColor(0x80, 0x84, 0x88));
  return made;
}

QPalette lightPalette() {
  QPalette made(QColor(0xef, 0xef, 0xef), QColor(0xef, 0xef, 0xef));
  for (const Role role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText, QPalette::ToolTipText})
    made.setColor(role, Qt::black);
  made.setColor(QPalette::Base, Qt::white);
  made.setColor(QPalette::AlternateBase, QColor(0xf5, 0xf5, 0xf5));
  made.setColor(QPalette::ToolTipBase, QColor(0xff, 0xff, 0xe6));
  made.setColor(QPalette::PlaceholderText, QColor(0x66, 0x66, 0x66));
  made.setColor(QPalette::Highlight, QColor(0x1f, 0x6f, 0xa8));
  made.setColor(QPalette::HighlightedText, Qt::white);
  for (const Role role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText})
    made.setColor(QPalette::Disabled, role, QColor(0x8c, 0x8c, 0x8c));
  return made;
}

QColor either(const QColor& onLight, const QColor& onDark) { return dark() ? onDark : onLight; }

}  // namespace

QString wordOf(Choice choice) {
  switch (choice) {
    case Choice::light:
      return "light";
    case Choice::dark:
      return "dark";
    case Choice::system:
      break;
  }
  return "system";
}

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
QColor muted() { return either(QColor(0x50, 0x50, 0x50), QColor(0xb8, 0xbc, 0xc0)); }
QColor grid() { return either(QColor(0xe4, 0xe4, 0xe4), QColor(0x3c, 0x40, 0x44)); }
QColor first() { return either(QColor(0x00, 0x72, 0xb2), QColor(0x56, 0xb4, 0xe9)); }
QColor second() { return either(QColor(0xc0, 0x50, 0x00), QColor(0xf0, 0x8c, 0x3c)); }
QColor box() { return either(QColor(0xdd, 0xdd, 0xdd), QColor(0x4a, 0x4e, 0x53)); }
QColor trouble() { return either(QColor(0xa0, 0x42, 0x00), QColor(0xf4, 0xa2, 0x60)); }

QColor ofVerdict(Verdict verdict) {
  switch (verdict) {
    case Verdict::verified:
      return either(QColor(0x00, 0x5a, 0x8e), QColor(0x7c, 0xc4, 0xf0));
    case Verdict::diverged:
      return trouble();
    case Verdict::damaged:
      return either(QColor(0x8b, 0x2a, 0x5e), QColor(0xe9, 0xa0, 0xcf));
    case Verdict::notCheckableHere:
    case Verdict::notChecked:
      break;
  }
  return muted();
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

}  // namespace calot::gui::theme
