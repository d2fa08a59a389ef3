// SPDX-License-Identifier: GPL-3.0-or-later
// What a program with a window checks before it has one, so that it can say so in one line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace calot::apps {

/// @param what is written there: "recordings"
/// @throws Error (invalid) where there is no such folder, (failure) where nothing can be written in it
void requireFolder(const std::string& folder, const std::string& what);

/// Qt itself ends the program with several lines where it finds no screen.
/// @throws Error (failure) where the environment names none
void requireScreen();

/// Adds --graphics: what draws the pictures of the scene.
void addGraphics(CLI::App& app, std::string& word);
/// The windows' pictures are drawn so. @throws Error (failure) where this machine has no such graphics
void useGraphics(const std::string& word);

/// For CLI::Option::check: a number of seconds above 0. The parser alone takes "nan" and "inf".
/// @return empty, or the fault
std::string positiveSeconds(const std::string& text);

}  // namespace calot::apps
