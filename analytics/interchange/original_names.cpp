// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/original_names.h"

#include <algorithm>

namespace calot::analytics {
namespace {

/// A figure, but for a day ("2026-01-31"), or a single letter.
bool saysNothing(std::string_view name) {
  const bool figure = std::all_of(name.begin(), name.end(),
                                  [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+'; });
  const bool day = name.size() == 10 && std::count(name.begin(), name.end(), '-') == 2;
  return name.size() < 2 || (figure && !day);
}

bool inWord(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-' ||
         static_cast<unsigned char>(c) >= 0x80;
}

bool inCell(char c) { return c != ',' && c != '"' && c != '\n'; }

}  // namespace

void OriginalNames::add(const std::string& name, const char* kind) {
  if (!saysNothing(name)) kindOf_.emplace(name, kind);
}

std::string OriginalNames::firstIn(std::string_view text, const std::set<std::string>& vocabulary) const {
  for (bool (*belongs)(char) : {inCell, inWord}) {
    for (std::size_t i = 0; i < text.size();) {
      std::size_t end = i;
      while (end < text.size() && belongs(text[end])) ++end;
      const auto at = kindOf_.find(text.substr(i, end - i));
      if (at != kindOf_.end() && vocabulary.count(at->first) == 0) return at->second;
      i = end + 1;
    }
  }
  return {};
}

}  // namespace calot::analytics
