// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/report/offscreen_application.h"

#include <clocale>
#include <QFontDatabase>
#include <string>

#include "recorder/base/errors.h"

namespace calot::gui {

OffscreenApplication::OffscreenApplication() {
  if (QCoreApplication::instance() != nullptr) return;
  const std::string locale = std::setlocale(LC_ALL, nullptr);
  const QtMessageHandler before = qInstallMessageHandler([](QtMsgType, const QMessageLogContext&, const QString&) {});
  application_ = std::make_unique<QGuiApplication>(count_, words_);
  qInstallMessageHandler(before);
  std::setlocale(LC_ALL, locale.c_str());
}

QFont reportFont() {
  if (QFontDatabase::families().isEmpty())
    throw Error(ErrorKind::failure, "no font is installed, and a PDF needs one (Debian: fonts-dejavu-core)");
  QFont font;
  font.setFamilies({"DejaVu Sans", "Liberation Sans", "Sans Serif"});
  return font;
}

}  // namespace calot::gui
