// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/window/look_options.h"

#include <algorithm>
#include <QStringList>

#include "gui/attempt/theme.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::apps {

void addLook(CLI::App& options, LookOptions& look, const std::string& usual) {
  options.add_option("--colours", look.colours, "light, dark, or system; default: " + usual)
      ->check(CLI::IsMember({"system", "light", "dark"}));
  options.add_option("--type", look.type, "Size of letters in per cent of the system's; default: " + usual)
      ->check(CLI::Range(gui::theme::usualType, gui::theme::largestType));
  options.add_option("--size", look.size, "WIDTHxHEIGHT of the window in pixels; default: most of the screen");
}

QSize windowSize(const LookOptions& look) {
  if (look.size.empty()) return {};
  constexpr int least = 640, most = 8192;
  const QStringList parts = QString::fromStdString(look.size).split('x');
  bool known[2] = {false, false};
  const QSize size(parts[0].toInt(&known[0]), parts.size() == 2 ? parts[1].toInt(&known[1]) : 0);
  if (!known[0] || !known[1] || std::min(size.width(), size.height()) < least || size.width() > most ||
      size.height() > most)
    throw Error(ErrorKind::invalid,
                "--size " + recorder::shown(look.size) + ": WIDTHxHEIGHT is wanted, of 640 to 8192 pixels");
  return size;
}

}  // namespace calot::apps
