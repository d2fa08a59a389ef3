// SPDX-License-Identifier: GPL-3.0-or-later
// Where the keyboard begins on a page. No focus proxy: Tab would pass over what stands before it.
#pragma once

#include <QVariant>
#include <QWidget>

namespace calot::gui {

/// Property of a page: the widget (QObject*) that one begins with.
inline constexpr const char* beginProperty = "begin";

inline void focusBegin(QWidget& page) {
  auto* begin = qobject_cast<QWidget*>(page.property(beginProperty).value<QObject*>());
  (begin != nullptr ? begin : &page)->setFocus(Qt::OtherFocusReason);
}

}  // namespace calot::gui
