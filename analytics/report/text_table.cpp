// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace calot::analytics {
namespace {

/// Columns on the terminal: code points, so that a degree sign counts once.
std::size_t widthOf(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

}  // namespace

TextTable::TextTable(std::vector<std::pair<std::string, Align>> columns) : columns_(std::move(columns)) {}

void TextTable::add(std::vector<std::string> cells) {
  assert(cells.size() == columns_.size());
  rows_.push_back(std::move(cells));
}

void TextTable::print(std::ostream& out) const {
  std::vector<std::size_t> width(columns_.size(), 0);
  std::vector<bool> shown(columns_.size(), false);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    width[c] = widthOf(columns_[c].first);
    for (const auto& row : rows_) {
      width[c] = std::max(width[c], widthOf(row[c]));
      shown[c] = shown[c] || !row[c].empty();
    }
  }
  const auto line = [&](const auto& cell, char fill) {
    std::string text;
    bool first = true;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (!shown[c]) continue;
      if (!first) text += "  ";
      first = false;
      const std::string content = cell(c);
      const std::string padding(width[c] - std::min(width[c], widthOf(content)), fill);
      text += columns_[c].second == Align::left ? content + padding : padding + content;
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out << text << '\n';
  };
  line([&](std::size_t c) { return columns_[c].first; }, ' ');
  line([](std::size_t) { return std::string(); }, '-');
  for (const auto& row : rows_) line([&](std::size_t c) { return row[c]; }, ' ');
}

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  if (value == 0.0) return "0";
  const double size = std::abs(value);
  if (size < 1e-4 || size >= 1e7) return fmt::format("{:.{}e}", value, digits - 1);
  const int magnitude = static_cast<int>(std::floor(std::log10(size)));
  return fmt::format("{:.{}f}", value, std::clamp(digits - 1 - magnitude, 0, 8));
}

std::string pText(double p) { return p < 0.0001 ? "<0.0001" : fmt::format("{:.4f}", p); }

}  // namespace calot::analytics
