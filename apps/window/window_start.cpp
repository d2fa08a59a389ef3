// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/window/window_start.h"

#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>

#include "apps/common/program.h"
#include "gui/attempt/widget_parts.h"
#include "gui/render/graphics.h"
#include "gui/render/image.h"
#include "gui/view/scene_picture_widget.h"
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

std::optional<QSize> windowSize(const LookOptions& look) {
  if (look.size.empty()) return std::nullopt;
  constexpr int least = 640, most = 8192;
  const std::optional<gui::PictureSize> size = gui::readSize(look.size);
  if (!size || std::min(size->width, size->height) < least || std::max(size->width, size->height) > most)
    throw Error(ErrorKind::invalid,
                "--size " + recorder::shown(look.size) + ": WIDTHxHEIGHT is expected, of 640 to 8192 pixels");
  return QSize(size->width, size->height);
}

void requireFolder(const std::string& folder, const std::string& what) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored))
    throw Error(ErrorKind::invalid, Where{folder}, fmt::format("is not a folder; {} go into one that exists", what));
  // Rights alone do not tell: a file system may take no files, or be for reading only.
  std::string trial = folder + "/.calot-XXXXXX";
  const int file = ::mkstemp(trial.data());
  if (file < 0)
    throw Error(ErrorKind::failure, Where{folder},
                fmt::format("{} cannot be written there: {}", what, std::strerror(errno)));
  ::close(file);
  ::unlink(trial.c_str());
}

namespace {

QString screenFault;
QtMessageHandler messagesBefore = nullptr;

/// Takes what Qt says while it looks for a screen.
void onScreenMessage(QtMsgType type, const QMessageLogContext& context, const QString& message) {
  if (type == QtFatalMsg) {
    fmt::print(stderr, "{}: there is no screen to show a window on: {}\n", program_invocation_short_name,
               screenFault.toStdString());
    std::_Exit(static_cast<int>(ExitCode::failure));
  }
  if (!message.contains("display") && !message.contains("plugin")) return messagesBefore(type, context, message);
  if (screenFault.isEmpty()) screenFault = message;  // the first one says why
}

}  // namespace

std::unique_ptr<QApplication> openScreen(int& argc, char** argv) {
  const auto variable = [](const char* name) -> std::string {
    const char* const value = std::getenv(name);
    return value != nullptr ? value : "";
  };
  const std::string platform = variable("QT_QPA_PLATFORM");
  const bool onScreen = platform.empty() || platform.starts_with("xcb") || platform.starts_with("wayland");
  if (onScreen && variable("DISPLAY").empty() && variable("WAYLAND_DISPLAY").empty())
    throw Error(ErrorKind::failure,
                "there is no screen to show a window on (DISPLAY is not set); xvfb-run gives a virtual one");
  messagesBefore = qInstallMessageHandler(nullptr);
  qInstallMessageHandler(onScreenMessage);
  auto application = std::make_unique<QApplication>(argc, argv);
  qInstallMessageHandler(nullptr);
  QApplication::setApplicationName("Calot");
  return application;
}

void addGraphics(CLI::App& app, std::string& word) {
  app.add_option("--graphics", word,
                 "what draws: auto (a graphics card where there is one), card, software, egl-software (to try a card's "
                 "way without one)")
      ->check(CLI::IsMember(gui::graphicsWords()))
      ->default_str("auto");
}

void useGraphics(const std::string& word) {
  const gui::Graphics graphics = gui::graphicsFrom(word);
  if (graphics != gui::Graphics::automatic) static_cast<void>(gui::createContext(graphics));
  gui::ScenePictureWidget::drawBy(graphics);
}

}  // namespace calot::apps
