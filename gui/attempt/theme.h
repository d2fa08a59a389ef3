// SPDX-License-Identifier: GPL-3.0-or-later
// Light and dark, and how large letters are. All colours of text in these windows keep WCAG 2.1's contrast of level AA
// to what is behind them.
#pragma once

#include <QColor>
#include <QIcon>
#include <QPalette>
#include <QSize>
#include <QString>
#include <QStyle>

#include "analytics/cohort/cohort_database.h"

class QLabel;

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
