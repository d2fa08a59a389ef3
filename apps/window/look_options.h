// SPDX-License-Identifier: GPL-3.0-or-later
// How a window looks: light or dark, how large its letters are, and how large it is.
#pragma once

#include <CLI/CLI.hpp>
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

/// The size that was asked for; none: null. @throws calot::Error (invalid)
QSize windowSize(const LookOptions& look);

}  // namespace calot::apps
