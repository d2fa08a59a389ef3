// SPDX-License-Identifier: GPL-3.0-or-later
// How a window looks: light or dark, how large its letters are, and how large it is.
// Checks made by a windowed program before it opens a window, to report faults in one line.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <QApplication>
#include <QSize>
#include <string>

namespace calot::apps {

struct LookOptions {
  std::string colours;  ///< "light", "dark", "system"; empty: not given
  std::string size;     ///< "1366x768"; empty: not given
  int type = 0;         ///< per cent; 0: not given
};

/// Adds --colours, --type and --size. @param usual what holds where one of the first two is not given
void addLook(CLI::App& options, LookOptions& look, const std::string& usual);

/// The size that was asked for, if any. @throws calot::Error (invalid)
std::optional<QSize> windowSize(const LookOptions& look);

/// @param what is written there: "recordings"
/// @throws Error (invalid) where there is no such folder, (failure) where nothing can be written in it
void requireFolder(const std::string& folder, const std::string& what);

/// Qt itself would end the program with several lines, or a core dump, where it finds no screen: this ends it with one.
/// @param argc and argv outlive the application @throws Error (failure) where the environment names no screen
std::unique_ptr<QApplication> openScreen(int& argc, char** argv);

/// Adds --graphics: what draws the pictures of the scene.
void addGraphics(CLI::App& app, std::string& word);
/// The windows' pictures are drawn so. @throws Error (failure) where this machine has no such graphics
void useGraphics(const std::string& word);

}  // namespace calot::apps
