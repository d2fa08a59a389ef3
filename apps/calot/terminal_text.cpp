// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/terminal_text.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

namespace calot::apps {
namespace {

constexpr std::size_t withoutTerminal = 80;

/// Columns of a word: code points.
std::size_t columnsOf(const std::string& word) {
  return static_cast<std::size_t>(
      std::count_if(word.begin(), word.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

}  // namespace

std::size_t terminalColumns() {
  winsize size{};
  if (isatty(STDOUT_FILENO) == 0 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
    return withoutTerminal;
  return std::clamp<std::size_t>(size.ws_col, 60, 160);
}

std::string wrappedText(const std::string& text, std::size_t columns, std::size_t indent, std::size_t used) {
  std::string out;
  std::istringstream lines(text);
  bool first = true;
  for (std::string line; std::getline(lines, line); first = false) {
    if (!first) out += '\n' + std::string(indent, ' ');
    std::size_t at = first ? used : indent;
    bool empty = true;
    std::istringstream words(line);
    for (std::string word; words >> word; empty = false) {
      const std::size_t width = columnsOf(word);
      if (!empty && at + 1 + width > columns) {
        out += '\n' + std::string(indent, ' ');
        at = indent;
        empty = true;
      }
      if (!empty) {
        out += ' ';
        ++at;
      }
      out += word;
      at += width;
    }
  }
  return out;
}

}  // namespace calot::apps
